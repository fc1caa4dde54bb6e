!> The files of a case: NAME.summary.json, the result for scripts, with the members that the summaries of decks, sweeps
!> and reduced problems share; and all files of a solved case, which are written as a whole or not at all.
module amontons_report
   use amontons_body, only: body_t
   use amontons_case_label, only: case_label_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_contact_table, only: add_point_table, column_t, contact_columns, pair_names
   use amontons_document, only: document_t, field, json_logical, json_number, json_numbers, json_string, &
      quantity_members
   use amontons_error, only: error_t, warning_list_t
   use amontons_friction_law, only: open_point, stick_point
   use amontons_key_results, only: interval_t, resultants
   use amontons_kinds, only: dp, int64
   use amontons_listing, only: new_listing, solutions_table_text
   use amontons_manifest, only: find_earlier_files, manifest_t, with_manifest
   use amontons_output_file, only: commit_files, output_file_t, write_text_file
   use amontons_quantity, only: quantity_t, scales
   use amontons_result, only: certificate_limit, has_bar, has_converged, outcome_word, result_t, verdict_names
   use amontons_system, only: file_name_t, make_directory, peak_memory_mb
   use amontons_terminal, only: phase_names, phase_write, timings_t
   use amontons_text, only: comma_separated, newline, to_text
   use amontons_uniqueness, only: uniqueness_t
   use amontons_version, only: version
   use amontons_vtu, only: write_case_grids
   implicit none (type, external)
   private

   public :: add_head, case_documents, certificate_member, commit_case, effort_members, last_members, member, &
      member_value, new_summary, quantities_member, size_counts, status_members, study_files_t, uniqueness_member, &
      write_documents, write_report

   !> The files that a study of several steps adds to those of the last one.
   type :: study_files_t
      type(output_file_t), allocatable :: files(:) !! the finished files
      type(manifest_t) :: manifest !! its files in a folder of its own, and the files that it has read
   end type study_files_t

contains

   !> A member of a JSON object, followed by others.
   pure function member(name, value) result(text)
      character(*), intent(in) :: name !! its name
      character(*), intent(in) :: value !! its value in JSON
      character(:), allocatable :: text

      text = '  "'//name//'": '//value//','//newline
   end function member

   !> Adds the beginning of the object: the case, and whether it was solved.
   pure subroutine add_head(summary, label, method, outcome, warnings)
      type(document_t), intent(inout) :: summary !! gains the members
      class(case_label_t), intent(in) :: label !! name, title and units of the case
      character(*), intent(in) :: method !! the contact method
      character(*), intent(in) :: outcome !! its outcome, a word of `amontons_result`
      type(warning_list_t), intent(in) :: warnings !! its warnings
      character(:), allocatable :: text
      integer :: i

      summary%ending = '.summary.json'
      call summary%add('{'//newline//member('case', json_string(label%name))//member('title', &
         json_string(label%title)) //member('units', json_string(label%units)))
      call summary%record(member('version', json_string(version)))
      call summary%add(member('method', json_string(trim(method))))
      call summary%add(member('outcome', json_string(outcome))//member('converged', &
         json_logical(has_converged(outcome))))
      text = ''
      do i = 1, warnings%n()
         if (i > 1) text = text//', '
         text = text//json_string(warnings%item(i))
      end do
      call summary%add(member('warnings', '['//text//']'))
   end subroutine add_head

   !> Members on the iterations and the work of the method, and on the residual.
   pure function effort_members(solution) result(text)
      type(contact_solution_t), intent(in) :: solution !! the solution and its record
      character(:), allocatable :: text

      text = member('iterations', to_text(solution%n_iterations)) &
         //member('products', json_number(solution%effort%n_products)) &
         //member('factorizations', to_text(solution%effort%n_factorizations)) &
         //member('residual', json_number(solution%residual)) &
         //member('residual_history', '['//json_numbers(solution%history(:solution%n_iterations))//']')
   end function effort_members

   !> The member on the uniqueness of the solution.
   pure function uniqueness_member(uniqueness) result(text)
      type(uniqueness_t), intent(in) :: uniqueness !! the bound
      character(:), allocatable :: text, bound

      bound = 'null'
      if (uniqueness%has_bound .and. .not. uniqueness%is_for_any) bound = json_number(uniqueness%friction)
      text = member('uniqueness', '{"guaranteed": '//json_logical(uniqueness%is_unique)//', "friction_below": '//bound &
         //', "exact": '//json_logical(uniqueness%is_exact)//'}')
   end function uniqueness_member

   !> Sizes of the model, for the member `counts`.
   pure function size_counts(body) result(text)
      type(body_t), intent(in) :: body !! the body
      character(:), allocatable :: text

      text = '"nodes": '//to_text(body%mesh%n_nodes)//', "elements": '//to_text(body%mesh%n_elements) &
         //', "dofs": '//to_text(body%dof_map%n_dofs)//', "contact_points": '//to_text(body%zone%n_points)
   end function size_counts

   !> Numbers of points that are open, stick and slip, for the member `counts`.
   pure function status_members(status) result(text)
      integer, intent(in) :: status(:) !! statuses of the points
      character(:), allocatable :: text

      text = '"open": '//to_text(count(status == open_point))//', "stick": '//to_text(count(status == stick_point)) &
         //', "slip": '//to_text(count(status /= open_point .and. status /= stick_point))
   end function status_members

   !> A member of the summary that has quantities by their names.
   pure function quantities_member(name, quantities) result(text)
      character(*), intent(in) :: name !! its name
      type(quantity_t), intent(in) :: quantities(:) !! the quantities
      character(:), allocatable :: text

      text = member(name, '{'//quantity_members(quantities)//'}')
   end function quantities_member

   !> The certificate as a member: the verdict, the limit, the violations, and related numbers.
   pure function certificate_member(violations, limit, others, head) result(text)
      type(quantity_t), intent(in) :: violations(:) !! the violations [-]
      real(dp), intent(in) :: limit !! the limit of all violations [-]
      type(quantity_t), intent(in) :: others(:) !! the other numbers
      character(*), intent(in), optional :: head !! members before these
      character(:), allocatable :: text

      text = ''
      if (present(head)) text = head
      text = member('certificate', '{'//text//'"passed": '//json_logical(all(violations%value <= limit))//', '// &
         quantity_members([quantity_t('limit', '', limit), violations, others])//'}')
   end function certificate_member

   !> Times and memory, and the end of the object.
   function last_members(timings) result(text)
      type(timings_t), intent(in) :: timings !! the times
      character(:), allocatable :: text
      integer :: i

      text = quantities_member('seconds', [(quantity_t(phase_names(i), '', timings%seconds(i)), &
         i=1, size(phase_names)), quantity_t('total', '', sum(timings%seconds))]) &
         //'  "peak_memory_mb": '//json_number(peak_memory_mb())//newline//'}'//newline
   end function last_members

   !> The text of a member's value in a summary, up to the comma or bracket behind it; empty if there is no such member.
   pure function member_value(summary, section, name) result(value)
      character(*), intent(in) :: summary !! the summary
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: name !! its name
      character(:), allocatable :: value
      integer :: first, last

      value = ''
      if (len(section) == 0) then
         first = index(summary, newline//'  "'//name//'": ') + 1
         last = first + index(summary(first:), newline) - 2
      else
         first = index(summary, newline//'  "'//section//'": {') + 1
         last = first + index(summary(first:), newline) - 2
         if (first > 1) first = first + index(summary(first:last), '"'//name//'": ') - 1
      end if
      if (first < 2 .or. summary(first:first) == newline .or. last < first) return
      first = first + index(summary(first:last), '": ') + 2
      if (len(section) > 0) last = first + scan(summary(first:last), ',}') - 2
      if (len(section) == 0 .and. summary(last:last) == ',') last = last - 1
      value = summary(first:last)
   end function member_value

   !=summary `case`, `title`, `units` | | from the deck; `units` is empty if it names none
   !=summary `version` | | version of the program
   !=summary `method` | | the contact method
   !=summary `outcome` | | `solved`, `not_converged`, `not_certified` or `no_equilibrium`: [what they
   !=   mean](#exit-status-and-outcomes). Of the last, the summary has `message` and no numbers. A sweep is
   !=   `no_equilibrium` where none of its cases has one, and has `message`, too
   !=summary `converged` | | whether the residual is at most the tolerance
   !=summary `warnings` | | what is doubtful about model and result, a text each; mostly empty
   !=summary `iterations` | | iterations of the method; of all stages with `auto`
   !=summary `products` | – | what they took, in products of $S$ or $A$ with a vector. A part of the matrix counts by
   !=   its size, a sweep by the columns it uses, a pivot of `lemke` as 9/4 (its tableau is 3m x 3m); triangular solves
   !=   do not count
   !=summary `factorizations` | | factorizations they took, of any order; with methods that use $A$ the one of $S$ too,
   !=   if it was not there from an earlier case
   !=summary `residual` | – | residual of the contact problem
   !=summary `residual_history` | – | residual after each iteration
   !=summary `method_error` | – | only for a run that stagnated at a wrong answer: largest error of a contact force,
   !=   over the largest exact one
   !=summary `inf_sup` | – | only with constant multipliers: their inf-sup constant, the smallest of all contact sets
   !=summary `condition` | – | only where the certificate comes near its limit in `equilibrium`, `resultant`, `moment`
   !=   or `energy` (above 1e-9) and the number explains it (above 1e8): estimated condition number of the stiffness
   !=   (1-norm), or $|K| |u| / |f|$ if this is larger, whose decimal logarithm is how many of 16 digits rounding may
   !=   cost
   !=summary `certificate` | | see below
   !=summary `uniqueness.guaranteed` | | whether the friction is below a bound that makes the solution unique, rigid
   !=   motions aside that nothing holds without friction (the listing names one); `false` does not mean that there are
   !=   several solutions
   !=summary `uniqueness.friction_below` | – | that bound on the largest coefficient; `null` if none is known, or if any
   !=   friction will do
   !=summary `uniqueness.exact` | | whether just above the bound some loads have several solutions
   !=summary `counts.nodes`, `.elements` | | size of the mesh
   !=summary `counts.dofs` | | unknown displacement components
   !=summary `counts.contact_points` | | contact points $m$
   !=summary `counts.open`, `.stick`, `.slip` | | points by status; `slip` counts both directions
   !=summary `factor.entries`, `.flops` | | stored entries of the factor, and floating-point operations it took
   !=summary `key_results` | | see [Key results](#key-results)
   !=summary `accuracy.error_norm` | √(F L) | estimated error of the stresses in the norm of the strain energy; see
   !=   [Accuracy](#accuracy)
   !=summary `accuracy.relative_error` | – | its ratio to the norm of the stresses
   !=summary `convergence` | | only with `&accuracy refinements`: every number of [`NAME.convergence.csv`](#accuracy) by
   !=   its name, with `values`, `verdict`, `order`, `extrapolated`, `error_bar`
   !=summary `lengths.open_length`, `.slip_length`, `.stick_length` | L | see [Lengths](#lengths)
   !=summary `closed_zones`, `stick_zones` | L | what is closed, and what sticks ([ends](#zones-and-their-ends)): of
   !=   each part the contact set, length, `start_x`, `start_y`, `end_x`, `end_y`
   !=summary `resultants.normal_force`, `.tangential_force` | F | sums of the normal and of the tangential forces
   !=summary `seconds.read`, `.assemble`, `.factorize`, `.condense`, `.solve`, `.recover`, `.write`, `.total` | s |
   !=   making mesh, supports, contact zone and loads, and checking their balance; element stiffness and assembly;
   !=   ordering and Cholesky factorization; condensed stiffness and load; the contact method, and the search for all
   !=   solutions; displacements of all nodes, certificate, lengths; the other files and their checksums; their sum
   !=summary `peak_memory_mb` | MB | most memory the process held so far
   !=summary `files` | | `name`, `bytes` and `checksum` of every other file that the case left, grids of a sweep
   !=   included: its [manifest](#verification)
   !=summary `inputs` | | the same of the files that it was read from: mesh, tables, reduced problem. A pipe, or a file
   !=   that was gone when the results were written, is not in the list but counted in `unlisted_inputs`
   !=summary `checksum` | | checksum of the summary itself, up to the line of this member
   !> Makes the summary.
   subroutine new_summary(summary, label, body, result)
      type(document_t), intent(out) :: summary !! the summary
      class(case_label_t), intent(in) :: label !! name, title and units of the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i

      associate (solution => result%solution, certificate => result%certificate)
         call add_head(summary, label, result%method%method, outcome_word(result), result%warnings)
         if (allocated(result%answer)) then
            call summary%add(member('message', json_string(result%answer)))
            call summary%add(member('counts', '{'//size_counts(body)//'}'))
            call summary%record(last_members(result%timings))
            return
         end if
         call summary%append(result%study_members)
         call summary%record(effort_members(solution))
         if (result%method_error >= 0.0_dp) call summary%record(member('method_error', &
            json_number(result%method_error)))
         if (any(result%load_case%contacts%partition%is_constant)) call summary%add(member('inf_sup', &
            json_number(minval(body%inf_sup))))
         if (result%condition > 0.0_dp) call summary%record(member('condition', json_number(result%condition)))
         call summary%add(certificate_member(certificate%violations(), certificate_limit(result%method%tolerance), &
            certificate%energies()), [1.0_dp, scales([certificate%violations(), certificate%energies()])])
         call summary%record(uniqueness_member(result%uniqueness))
         call summary%add(quantities_member('key_results', result%key_results), scales(result%key_results))
         call summary%add(member('counts', '{'//size_counts(body)//', '//status_members(solution%status)//'}'))
         call summary%record(member('factor', '{"entries": '//to_text(result%factor%n_entries)//', "flops": '// &
            to_text(nint(result%factor%n_flops, int64))//'}'))
         if (result%lengths%are_areas) then
            call summary%add(quantities_member('areas', result%lengths%quantities()))
         else
            call summary%add(quantities_member('lengths', result%lengths%quantities()))
            call summary%add(intervals_member('closed_zones', result%closed), [maxval(abs(body%zone%position))])
            call summary%add(intervals_member('stick_zones', result%stuck), [maxval(abs(body%zone%position))])
         end if
         call summary%add(quantities_member('resultants', resultants(solution%force, &
            size(solution%status), result%lengths%are_areas)), scales(resultants(solution%force, &
            size(solution%status), result%lengths%are_areas)))
         if (allocated(result%error_estimate)) call summary%add(quantities_member('accuracy', &
            result%error_estimate%quantities()), scales(result%error_estimate%quantities()))
         if (allocated(result%convergence)) then
            ! The numbers of a case on refined meshes as a member.
            text = ''
            do i = 1, size(result%convergence)
               associate (judged => result%convergence(i)%convergence)
                  if (i > 1) text = text//', '
                  text = text//json_string(trim(result%convergence(i)%quantity%key))//': {"values": ['// &
                     json_numbers(judged%value)//'], "verdict": '//json_string(trim(verdict_names(judged%verdict)))// &
                     ', '//quantity_members([quantity_t('order', '', judged%order), quantity_t('extrapolated', '', &
                     judged%extrapolated)])//', "error_bar": '
                  if (has_bar(judged)) text = text//json_number(judged%bar)//'}'
                  if (.not. has_bar(judged)) text = text//'null}'
               end associate
            end do
            text = member('convergence', '{'//text//'}')
            call summary%add(text)
         end if
         call summary%record(last_members(result%timings))
      end associate
   end subroutine new_summary

   !> Parts of the contact line as a member.
   pure function intervals_member(name, intervals) result(text)
      character(*), intent(in) :: name !! its name
      type(interval_t), intent(in) :: intervals(:) !! the parts
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(intervals)
         associate (ends => intervals(i)%ends)
            text = text//', {"set": '//to_text(intervals(i)%set)//', '//quantity_members([ &
               quantity_t('length', '', intervals(i)%length), &
               quantity_t('start_x', '', ends(1, 1)), quantity_t('start_y', '', ends(2, 1)), &
               quantity_t('end_x', '', ends(1, 2)), quantity_t('end_y', '', ends(2, 2))])//'}'
         end associate
      end do
      text = member(name, '['//text(min(3, len(text) + 1):)//']')
   end function intervals_member

   !> Writes NAME.lst, NAME.contact.csv, NAME.vtu, NAME.contact.vtu and NAME.summary.json, NAME.deck.nml if there is a
   !> deck, and NAME.solutions.csv if all solutions are known. Without a solution only listing, deck and summary are
   !> written. The files get their final names when all are complete.
   subroutine write_report(directory, label, body, result, error, study)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      class(case_label_t), intent(in) :: label !! what the case is called: a configuration, or `new_case_label`
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(study_files_t), intent(in), optional :: study !! the files of a study of several steps
      type(document_t), allocatable :: documents(:)
      type(document_t) :: summary
      type(output_file_t), allocatable :: files(:)
      type(study_files_t) :: added
      character(:), allocatable :: stem
      integer :: n, n_grids

      call make_directory(directory, error)
      if (allocated(error)) return
      if (present(study)) added = study
      if (.not. allocated(added%files)) allocate (added%files(0))
      call case_documents(documents, label, body, result)
      n = size(documents)
      n_grids = merge(0, 2, allocated(result%answer))
      allocate (files(n + n_grids + size(added%files) + 1))
      files(n + n_grids + 1:size(files) - 1) = added%files
      stem = directory//'/'//label%name
      call write_documents(files, stem, documents, error)
      if (n_grids > 0 .and. .not. allocated(error)) call write_case_grids(files(n + 1:n + n_grids), stem, label%units, &
         body, result, error)
      call added%manifest%add_case(files, stem, result%has_reduced_files, error)
      if (.not. allocated(error)) then
         call added%manifest%add_inputs(body%mesh, result%load_case%contacts, result%load_case%loads)
         call result%timings%begin(phase_write)
         call new_summary(summary, label, body, result)
      end if
      call commit_case(files, added%manifest, directory, label%name, summary, error)
   end subroutine write_report

   !> Writes texts under their temporary names.
   subroutine write_documents(files, stem, documents, error)
      type(output_file_t), intent(inout) :: files(:) !! the files; the first ones become those of the texts
      character(*), intent(in) :: stem !! directory and name of the case
      type(document_t), intent(in) :: documents(:) !! the texts
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      integer :: i

      do i = 1, size(documents)
         call write_text_file(files(i), stem//documents(i)%ending, documents(i)%text(), error)
         if (allocated(error)) return
      end do
   end subroutine write_documents

   !> Writes the summary last, since it contains the time of writing, and gives all files their final names. Other files
   !> of an earlier run of the case are removed.
   subroutine commit_case(files, manifest, directory, name, summary, error)
      type(output_file_t), intent(inout) :: files(:) !! the finished files, the last one to become the summary
      type(manifest_t), intent(in) :: manifest !! the manifest of the others, and of what was read
      character(*), intent(in) :: directory !! output directory
      character(*), intent(in) :: name !! name of the case
      type(document_t), intent(in) :: summary !! the summary
      type(error_t), allocatable, intent(inout) :: error
         !! why the files are not complete, if they are not: they are then discarded; or why one cannot be written
      type(file_name_t), allocatable :: earlier(:)

      if (.not. allocated(error)) call write_text_file(files(size(files)), directory//'/'//name//summary%ending, &
         with_manifest(summary%text(), manifest), error)
      if (.not. allocated(error)) call find_earlier_files(earlier, directory, name, manifest)
      call commit_files(files, error, earlier)
   end subroutine commit_case

   !> Makes the text files of a case, except for the summary.
   subroutine case_documents(documents, label, body, result)
      type(document_t), allocatable, intent(out) :: documents(:) !! the files
      class(case_label_t), intent(in) :: label !! name, title and units of the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      character(:), allocatable :: deck, text
      integer :: n, i

      deck = label%deck_text()
      allocate (documents(1 + count([.not. allocated(result%answer), len(deck) > 0, allocated(result%convergence), &
         allocated(result%all_solutions)])))
      call new_listing(documents(1), label, body, result)
      n = 1
      if (.not. allocated(result%answer)) then
         n = n + 1
         call contact_columns(columns, body, result)
         call add_point_table(documents(n), columns, result%solution%status, &
            pair_names(body%zone, result%load_case%contacts))
      end if
      if (len(deck) > 0) then
         n = n + 1
         documents(n)%ending = '.deck.nml'
         call documents(n)%add(deck)
      end if
      if (allocated(result%convergence)) then
         n = n + 1
         documents(n)%ending = '.convergence.csv'
         ! NAME.convergence.csv: a row for each number, a column for each mesh.
         text = 'quantity'
         do i = 1, size(result%convergence(1)%convergence%value)
            text = text//',mesh_'//to_text(i)
         end do
         text = text//',verdict,order,extrapolated,error_bar'//newline
         do i = 1, size(result%convergence)
            associate (judged => result%convergence(i)%convergence)
               text = text//field(trim(result%convergence(i)%quantity%key))//','//comma_separated(judged%value)//','// &
                  trim(verdict_names(judged%verdict))//','//comma_separated([judged%order, judged%extrapolated])//','
               if (has_bar(judged)) text = text//comma_separated([judged%bar])
               text = text//newline
            end associate
         end do
         call documents(n)%add(text)
      end if
      if (.not. allocated(result%all_solutions)) return
      documents(n + 1)%ending = '.solutions.csv'
      call documents(n + 1)%record(solutions_table_text(result%all_solutions, result%load_case%free_gap))
   end subroutine case_documents

end module amontons_report
