#!/usr/bin/env bash
# Makes the meshes of strip.geo and block.geo again: every element, version and encoding; and those of patch.geo. Needs
# gmsh 4.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")"

mesh() {
   local name=$1 shape=$2 degree=$3 has_centers=$4 version
   local options=(-v 1 -2 -setnumber shape "$shape" -setnumber degree "$degree" -setnumber has_centers "$has_centers")
   for version in 22 41; do
      gmsh "${options[@]}" -format "msh$version" strip.geo -o "$name-$version.msh"
      gmsh "${options[@]}" -format "msh$version" -bin strip.geo -o "$name-$version-binary.msh"
   done
   # This version is written as text only.
   gmsh "${options[@]}" -format msh40 strip.geo -o "$name-40.msh"
}

solid() {
   local name=$1 shape=$2 degree=$3 version
   local options=(-v 1 -3 -setnumber shape "$shape" -setnumber degree "$degree")
   for version in 22 41; do
      gmsh "${options[@]}" -format "msh$version" block.geo -o "$name-$version.msh"
      gmsh "${options[@]}" -format "msh$version" -bin block.geo -o "$name-$version-binary.msh"
   done
   gmsh "${options[@]}" -format msh40 block.geo -o "$name-40.msh"
}

solid tet4 4 1
solid tet10 4 2
solid hex8 8 1
solid hex20 8 2

mesh tri3 3 1 1
mesh tri6 3 2 1
mesh quad4 4 1 1
mesh quad8 4 2 0
mesh quad9 4 2 1
mesh mixed 7 2 0

# Curves become bars in this format, and their points are saved with them.
gmsh -v 1 -2 -setnumber shape 3 strip.geo -o tri3.inp
gmsh -v 1 -2 -setnumber shape 4 -setnumber degree 2 -setnumber has_centers 0 strip.geo -o quad8.inp
gmsh -v 1 -3 -setnumber degree 2 block.geo -o tet10.inp
gmsh -v 1 -3 -setnumber shape 8 -setnumber degree 2 block.geo -o hex20.inp
for version in 22 41; do
   gmsh -v 1 -2 -parametric -format "msh$version" strip.geo -o "parametric-$version.msh"
   gmsh -v 1 -2 -parametric -format "msh$version" -bin strip.geo -o "parametric-$version-binary.msh"
done
gmsh -v 1 -2 -parametric -format msh40 strip.geo -o parametric-40.msh

patch() {
   local name=$1 shape=$2 degree=$3 has_centers=$4
   gmsh -v 1 -2 -setnumber shape "$shape" -setnumber degree "$degree" -setnumber has_centers "$has_centers" \
      -format msh41 patch.geo -o "patch-$name.msh"
}

patch tri3 3 1 1
patch tri6 3 2 1
patch quad4 4 1 1
patch quad8 4 2 0
patch quad9 4 2 1
