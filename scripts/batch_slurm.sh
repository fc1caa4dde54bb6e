#!/usr/bin/env bash
# Solves the decks of a folder as a Slurm job array, one task of the array for each deck. With several ranks (--ntasks)
# each deck is solved over them, by a program built with MPI.
# Usage: sbatch --array=1-$(ls FOLDER/*.nml | wc -l) batch_slurm.sh FOLDER OUTPUT [PROGRAM-OPTION...]
# Edit the lines below for your cluster. AMONTONS names the program; without it, it must be in the PATH. LAUNCHER starts
# it on several ranks, e.g. 'srun --mpi=pmix'; without it, mpiexec does. What one rank needs, as
# `mpiexec -n RANKS amontons --check` shows, must be below cpus-per-task times mem-per-cpu.
#SBATCH --job-name=amontons
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=2
#SBATCH --mem-per-cpu=2G
#SBATCH --time=00:30:00
#SBATCH --output=amontons_%A_%a.log
set -euo pipefail

folder=${1:?name the folder of the decks}
output=${2:?name the folder of the results}
shift 2
# A name that begins with a dash would be taken for an option.
[[ $folder != -* ]] || folder=./$folder
[[ $output != -* ]] || output=./$output
decks=("$folder"/*.nml)
task=${SLURM_ARRAY_TASK_ID:?submit this with sbatch --array=1-${#decks[@]}}
if ((task < 1 || task > ${#decks[@]})); then
   echo "batch_slurm.sh: there is no deck $task of ${#decks[@]} in $folder" >&2
   exit 1
fi
launcher=()
if ((${SLURM_NTASKS:-1} > 1)); then
   read -ra launcher <<<"${LAUNCHER:-mpiexec -n $SLURM_NTASKS}"
   # Else Open MPI binds a rank with all its threads to one core; Slurm keeps a job on its own cores.
   export OMPI_MCA_hwloc_base_binding_policy=none
fi
exec "${launcher[@]}" "${AMONTONS:-amontons}" --threads "${SLURM_CPUS_PER_TASK:-1}" \
   --output "$output" "$@" "${decks[task - 1]}"
