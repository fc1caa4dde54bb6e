!> The configuration of a case: the contents of a deck, checked and with every default. One description of all groups
!> reads it, writes it as a deck again and documents the keys. Materials, supports and loads may come from the mesh
!> file; names of sets and regions are checked against the mesh, all at once.
module amontons_config
   use amontons_case_label, only: case_label_t
   use amontons_condensation, only: condensation_names, condensation_options_t
   use amontons_config_groups, only: accuracy_group, accuracy_options_t, add_driven_set, case_group, contact_group, &
      describe_accuracy, describe_case, describe_contact, describe_material, describe_mesh, describe_output, &
      describe_preload, describe_problem, describe_rigid, describe_support, describe_tie, driven_set_t, &
      material_group, mesh_group, output_group, preload_group, problem_group, reduced_source_t, rigid_group, &
      support_group, tie_group
   use amontons_config_loads, only: describe_load, load_group
   use amontons_constraints, only: support_t
   use amontons_contact_set, only: contact_t, new_contact, new_tie, tie_t
   use amontons_deck, only: apply_settings, read_deck, read_deck_text, read_settings, setting_t
   use amontons_deck_contents, only: suggestion
   use amontons_deck_visitor, only: body_words, deck_documenter_t, deck_visitor_t, deck_writer_t, group_t, key_t
   use amontons_error, only: error_t, fault_list_t, input_refused, new_error
   use amontons_file_model, only: file_model_t, use_contact, use_loads, use_materials, use_names, use_supports
   use amontons_history, only: describe_history, history_group, history_t, steps_group
   use amontons_kinds, only: dp
   use amontons_loads, only: load_on_motion, load_on_nodes, load_t
   use amontons_material, only: material_t
   use amontons_mesh, only: find_set, mesh_t
   use amontons_mesh_file, only: mesh_part_t, read_file_model
   use amontons_methods, only: acceleration_names, box_names, local_names, method_names, method_options_t, &
      space_names, variant_names
   use amontons_new_cholesky, only: factorization_names
   use amontons_rigid_set, only: rigid_components
   use amontons_sweep, only: describe_sweep, sweep_group, sweep_t
   use amontons_system, only: absolute_path
   use amontons_text, only: lower_case, quoted, to_text
   implicit none (type, external)
   private

   public :: body_text, check_names, config_t, effective_deck, new_reduced_config, read_config, read_config_text, &
      reference_text

   !> Name of the loads of a mesh file in a sweep.
   character(*), parameter :: file_load_name = 'mesh file'

   !> The group of the solver.
   type(group_t), parameter :: solver_group = group_t('solver')
   !> The groups that describe a body, its loads, what varies, and the required accuracy.
   type(group_t), parameter :: body_groups(*) = [mesh_group, material_group, support_group, load_group, rigid_group, &
      preload_group, contact_group, tie_group, sweep_group, history_group, steps_group, accuracy_group]
   !> All groups of a deck.
   type(group_t), parameter :: groups(*) = [case_group, problem_group, body_groups, solver_group, output_group]
   !> Names of each group in other programs, separated by blanks.
   character(32), parameter :: other_names(size(groups)) = [character(32) :: 'job heading', '', &
      'node nodes element elements part', 'elastic section', 'boundary bc constraint fix', 'cload dload', &
      'mpc coupling rigid_body', 'pretension pre_tension', 'interaction obstacle', '', 'parameter study', '', &
      'amplitude', '', 'static analysis', '']

   !> Everything that defines a case.
   type, extends(case_label_t) :: config_t
      type(reduced_source_t) :: reduced !! the reduced problem that there is instead of a body, if one is given
      type(mesh_part_t), allocatable :: meshes(:) !! the parts of its mesh, a body each
      integer :: n_dim = 0 !! number of dimensions that the keys of the deck state; 0 where none does
      character(:), allocatable :: dimension_key !! the key that states it first: 'traction of 3 numbers'
      integer :: dimension_line = 0 !! its line
      integer :: n_used(size(use_names) + 1) = 0
         !! numbers of materials, supports, loads, contact sets and ties that come from its file; they are the first
         !! ones
      type(material_t), allocatable :: materials(:) !! its materials
      type(support_t), allocatable :: supports(:) !! its supports
      type(load_t), allocatable :: loads(:) !! its loads
      type(driven_set_t), allocatable :: rigid_sets(:) !! its rigid sets; they are among its supports and loads, too
      type(driven_set_t), allocatable :: preloads(:) !! its preloads; they are among its ties, too
      type(contact_t), allocatable :: contacts(:) !! its contact sets
      type(tie_t), allocatable :: ties(:) !! its bonded sets
      type(sweep_t) :: sweep !! the quantities that vary from case to case; none for a single case
      type(history_t) :: history !! the load history; not given for a single case
      type(method_options_t) :: method !! the contact method
      type(accuracy_options_t) :: accuracy !! options on the accuracy of the results
      type(condensation_options_t) :: condensation !! options of the condensation
   contains
      procedure :: deck_text => effective_deck
   end type config_t

contains

   !> Reads a case from a deck. All faults are reported in one error, one line each; the meaning of a group is judged
   !> only if its form is right, and consequences of another fault are not reported.
   subroutine read_config(config, file, error, settings)
      type(config_t), intent(out) :: config !! the case
      character(*), intent(in) :: file !! name of the deck, `-` for standard input
      type(error_t), allocatable, intent(out) :: error !! the faults of the deck
      type(setting_t), intent(in), optional :: settings(:) !! settings that replace its values
      type(deck_visitor_t) :: reader

      call read_deck(reader%deck, file, error)
      if (.not. allocated(error)) call read_groups(config, reader, error, settings)
   end subroutine read_config

   !> Makes the case of a reduced problem's file without a deck: as if a deck named the file and nothing else.
   subroutine new_reduced_config(config, file, error, settings)
      type(config_t), intent(out) :: config !! the case
      character(*), intent(in) :: file !! name of the reduced problem's file
      type(error_t), allocatable, intent(out) :: error !! the name is not valid in a deck
      type(setting_t), intent(in), optional :: settings(:) !! settings that replace values of the deck
      type(deck_visitor_t) :: reader

      call read_deck_text(reader%deck, file, "&problem kind = 'reduced'  file = "//quoted(absolute_path(file))//' /')
      call read_groups(config, reader, error, settings)
      config%reduced%file = file
      config%reduced%origin = ''
   end subroutine new_reduced_config

   !> Reads a case from the text of a deck, with settings that replace its values.
   subroutine read_config_text(config, file, text, settings, error)
      type(config_t), intent(out) :: config !! the case
      character(*), intent(in) :: file !! name of the deck; names of files in it are seen from its folder
      character(*), intent(in) :: text !! the deck
      character(*), intent(in) :: settings !! the settings, one a line
      type(error_t), allocatable, intent(out) :: error !! the faults of the deck
      type(deck_visitor_t) :: reader
      type(setting_t), allocatable :: list(:)

      call read_settings(list, settings, error)
      if (allocated(error)) return
      call read_deck_text(reader%deck, file, text)
      call read_groups(config, reader, error, list)
   end subroutine read_config_text

   !> Reads the groups of a deck, with settings that replace its values.
   subroutine read_groups(config, reader, error, settings)
      type(config_t), intent(inout) :: config !! the case
      type(deck_visitor_t), intent(inout) :: reader !! the reader, with its deck
      type(error_t), allocatable, intent(out) :: error !! the faults of the deck
      type(setting_t), intent(in), optional :: settings(:) !! the settings

      config%file = reader%deck%file
      if (present(settings)) call apply_settings(reader%deck, settings)
      call reader%deck%refuse_unknown_groups(groups%name, other_names, pack(groups%name, groups%is_repeatable))
      call describe_config(reader, config)
      config%n_dim = reader%n_dim
      config%dimension_line = reader%dimension_line
      call move_alloc(reader%dimension_key, config%dimension_key)
      call reader%deck%finish(error)
   end subroutine read_groups

   !> The effective deck: the case as a deck with every default. Reading it gives the same case.
   function effective_deck(self) result(text)
      class(config_t), intent(in) :: self !! the case
      character(:), allocatable :: text

      call write_deck(text, self, .false.)
   end function effective_deck

   !> The part of the deck that determines the factorization: two cases with equal texts can share it.
   function body_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      call write_deck(text, config, .true.)
   end function body_text

   !> Writes the deck of a case, or only the part that decks with a common factorization share.
   subroutine write_deck(text, config, is_shared_only)
      character(:), allocatable, intent(out) :: text !! the deck
      type(config_t), intent(in) :: config !! the case
      logical, intent(in) :: is_shared_only !! whether only what such decks agree in is written
      type(deck_writer_t) :: writer
      type(config_t) :: copy

      copy = config
      ! What is used of the mesh file is read again with it.
      if (is_shared_only) copy%n_used = 0
      writer%is_shared_only = is_shared_only
      call describe_config(writer, copy)
      call move_alloc(writer%written, text)
   end subroutine write_deck

   !> The reference of a group as Markdown; of all groups where the name is empty.
   subroutine reference_text(name, text, error)
      character(*), intent(in) :: name !! name of the group, with or without `&`, in upper or lower case; or empty
      character(:), allocatable, intent(out) :: text !! the reference, its last line not ended
      type(error_t), allocatable, intent(out) :: error !! there is no such group
      type(deck_documenter_t) :: documenter
      type(config_t) :: config

      documenter%wanted = lower_case(name)
      if (index(documenter%wanted, '&') == 1) documenter%wanted = documenter%wanted(2:)
      documenter%written = ''
      config%file = ''
      allocate (config%meshes(1), config%materials(1), config%supports(1), config%loads(1), config%contacts(1), &
         config%rigid_sets(1), config%preloads(1), config%ties(1), config%sweep%axes(1), config%history%steps(1))
      config%history%is_given = .true.
      config%n_dim = 2
      call describe_config(documenter, config)
      text = documenter%written
      if (len(text) == 0) call new_error(error, input_refused, 'unknown group &'//documenter%wanted// &
         suggestion(documenter%wanted, groups%name, other_names, '&', 'groups'))
   end subroutine reference_text

   !> Describes all groups of a deck: those of a reduced problem, or those of a body.
   subroutine describe_config(visitor, config)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(config_t), intent(inout) :: config !! the case
      integer :: i

      visitor%n_dim = config%n_dim
      call describe_case(visitor, config)
      call describe_problem(visitor, config%reduced)
      if (config%reduced%is_given) then
         call refuse_body_groups(visitor)
      else
         ! Describes the groups of a body, of what acts on it and of what varies.
         call describe_meshes(visitor, config)
         do i = config%n_used(use_materials) + 1, size(config%materials)
            call describe_material(visitor, config%materials(i))
         end do
         do i = config%n_used(use_supports) + 1, size(config%supports)
            if (.not. config%supports(i)%is_driven()) call describe_support(visitor, config%supports(i))
         end do
         do i = config%n_used(use_loads) + 1, size(config%loads)
            if (config%loads(i)%target /= load_on_motion) call describe_load(visitor, config%loads(i))
         end do
         call describe_driven_sets(visitor, config)
         do i = config%n_used(use_contact) + 1, size(config%contacts)
            call describe_contact(visitor, config%contacts(i))
         end do
         do i = config%n_used(use_contact + 1) + 1, size(config%ties)
            if (.not. config%ties(i)%has_jump) call describe_tie(visitor, config%ties(i))
         end do
         call describe_sweep(visitor, config%sweep, config%loads, config%contacts)
         call describe_history(visitor, config%history, config%loads, config%supports, config%contacts, &
            any(config%materials%is_axisymmetric))
         call describe_accuracy(visitor, config%accuracy, .not. (config%sweep%is_given() .or. &
            config%history%has_start()))
      end if
      call describe_solver(visitor, config)
      call describe_output(visitor, config%sweep, config%history)
      if (.not. (config%history%has_fretting .and. allocated(config%contacts))) return
      call visitor%require(.not. any(config%materials%is_twisted), 'fretting', &
         "fretting = 'parameters' does not go with twist = .true.")
      call visitor%require(.not. any(config%contacts%slides_far()), 'fretting', &
         "fretting = 'parameters' does not go with sliding = 'finite'")
   end subroutine describe_config

   !> Describes rigid sets and preloads, and adds the supports, loads and ties that they are.
   subroutine describe_driven_sets(visitor, config)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(config_t), intent(inout) :: config !! the case
      logical :: has(size(rigid_components))
      integer :: i

      ! A body of revolution moves along its axis and, if it is twisted, turns about it.
      has = .not. any(config%materials%is_axisymmetric) .or. [.false., .true., .false., .false., .false., &
         any(config%materials%is_twisted)]
      do i = 1, size(config%rigid_sets)
         associate (set => config%rigid_sets(i))
            call describe_rigid(visitor, set%motion, set%drive, has)
            if (visitor%is_judging()) call add_driven_set(config%supports, config%loads, config%ties, set, has)
         end associate
      end do
      do i = 1, size(config%preloads)
         associate (set => config%preloads(i))
            call describe_preload(visitor, set%motion, set%drive, set%tie)
            if (visitor%is_judging()) call add_driven_set(config%supports, config%loads, config%ties, set, has)
         end associate
      end do
   end subroutine describe_driven_sets

   !> Reports the groups of a body in the deck of a reduced problem.
   subroutine refuse_body_groups(visitor)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      integer :: group, i

      do i = 1, size(body_groups)
         group = 0
         do
            group = visitor%deck%next_group(trim(body_groups(i)%name), group)
            if (group == 0) exit
            call visitor%deck%fault(group, '', '&'//trim(body_groups(i)%name)// &
               " does not go with &problem kind = 'reduced'")
         end do
      end do
   end subroutine refuse_body_groups

   !> Describes all `&mesh`; a reader allocates the items of the other groups, behind those of a mesh file.
   subroutine describe_meshes(visitor, config)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(config_t), intent(inout) :: config !! the case; gains what is used of a file
      type(error_t), allocatable :: error
      type(file_model_t) :: model
      logical :: is_new
      integer :: i, k, n

      is_new = .not. allocated(config%meshes)
      if (is_new) allocate (config%meshes(max(1, visitor%deck%count_groups('mesh'))))
      do i = 1, size(config%meshes)
         call describe_mesh(visitor, config%meshes(i))
         if (.not. (is_new .and. any(config%meshes(i)%is_used) .and. visitor%is_judging())) cycle
         call visitor%require(.not. any([(any(config%meshes(k)%is_used), k=1, i - 1)]), 'use', &
            'use is only for one &mesh')
         if (len(config%meshes(i)%file) == 0) cycle
         call read_file_model(model, config%meshes(i)%file, config%meshes(i)%is_used, config%meshes(i)%step, error)
         if (allocated(error)) then
            call visitor%require(.false., 'use', error%message)
            config%n_used = 0
            cycle
         end if
         config%n_used = [size(model%materials), size(model%supports), size(model%loads), &
            count(.not. model%contacts%is_tied), count(model%contacts%is_tied)]
      end do
      if (is_new) then
         ! Makes room for what the deck has of each kind, behind what its mesh file has.
         associate (n_used => config%n_used)
            ! A body without a material gets one whose required keys are reported as missing, unless the file is at
            ! fault.
            allocate (config%materials(max(merge(0, 1, allocated(error)), &
               n_used(1) + visitor%deck%count_groups('material'))))
            allocate (config%supports(n_used(2) + visitor%deck%count_groups('support')))
            allocate (config%loads(n_used(3) + visitor%deck%count_groups('load')))
            if (any(n_used > 0)) then
               config%materials(:n_used(1)) = model%materials
               config%supports(:n_used(2)) = model%supports
               config%loads(:n_used(3)) = model%loads
            end if
            do i = 1, n_used(3)
               config%loads(i)%name = file_load_name
            end do
            allocate (config%rigid_sets(visitor%deck%count_groups('rigid')), &
               config%preloads(visitor%deck%count_groups('preload')))
            allocate (config%contacts(n_used(use_contact) + visitor%deck%count_groups('contact')), &
               config%ties(n_used(use_contact + 1) + visitor%deck%count_groups('tie')))
            n = 0
            do i = 1, sum(n_used(use_contact:))
               associate (pair => model%contacts(i))
                  if (pair%is_tied) then
                     call new_tie(config%ties(i - n), trim(pair%set), trim(pair%against))
                     config%ties(i - n)%search = pair%search
                     config%ties(i - n)%origin = pair%origin
                  else
                     n = n + 1
                     call new_contact(config%contacts(n), trim(pair%set), pair%friction)
                     config%contacts(n)%pairing%against = trim(pair%against)
                     config%contacts(n)%origin = pair%origin
                  end if
               end associate
            end do
            allocate (config%sweep%axes(visitor%deck%count_groups('sweep')))
            allocate (config%history%steps(visitor%deck%count_groups('steps')))
            config%history%is_given = visitor%deck%count_groups('history') > 0
         end associate
      end if
   end subroutine describe_meshes

   !> Describes `&solver`: method, its options, factorization.
   subroutine describe_solver(visitor, config)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(config_t), intent(inout) :: config !! the case

      call visitor%open_group(solver_group)
      associate (method => config%method)
         call visitor%word(key_t('method', 'the contact method', also='solver algorithm type'), method%method, &
            method_names)
         call visitor%word(key_t('variant', 'of `splitting`: how half steps are done; only `exact` is right in'// &
            ' general'), method%variant, variant_names)
         call visitor%word(key_t('space', 'of `psor`: sweep in the forces or in the displacements'), method%space, &
            space_names)
         call visitor%real(key_t('omega', 'of `psor`: relaxation', above=0.0_dp, below=2.0_dp, &
            also='relaxation'), method%omega)
         call visitor%word(key_t('local', 'of `psor`: a point component by component, or both components at once,'// &
            ' exactly'), method%local, local_names)
         call visitor%word(key_t('acceleration', 'of `psor`: extrapolate the sweeps; what would raise the residual'// &
            ' is dropped'), method%acceleration, acceleration_names)
         call visitor%word(key_t('box', 'of `splitting` and `fixed_point`: solver of the quadratic programs:'// &
            ' projected Newton (active sets), or MPRGP, which needs products only; `auto` is the first unless A is'// &
            ' sparse'), method%box, box_names)
         call visitor%real(key_t('tolerance', 'residual that counts as solved, free of units', above=0.0_dp, &
            below=1.0_dp, also='tol eps'), method%tolerance)
         call visitor%whole(key_t('max_iterations', 'most iterations, of all stages together with `auto`', &
            at_least=1.0_dp, also='maxit maxiter max_iter itmax iterations'), method%max_iterations)
         call visitor%word(key_t('factorization', 'Cholesky factorization of the stiffness: band, multifrontal '// &
            "(formerly `'substructured'`), that of SuiteSparse, distributed over the ranks of an MPI run, or the "// &
            'one that suits', is_shared=.true.), config%condensation%factorization, factorization_names)
         call visitor%word(key_t('condensation', 'form of the stiffness of the contact points: a dense matrix, or a'// &
            ' band matrix of the whole body, which is quicker for long contact lines of slender bodies', &
            is_shared=.true.), config%condensation%form, condensation_names)
         if (config%condensation%form == 'band') call visitor%state_dimensions(2, 'condensation', " = 'band'")
         call visitor%close_group()
         call visitor%require(.not. (config%reduced%is_given .and. method%method == 'psor' .and. &
            method%space == 'primal'), 'space', &
            "space must be 'dual' for a reduced problem, which has no stiffness to sweep on")
         if (.not. allocated(config%contacts)) return
         call refuse_band(config%condensation%factorization == 'distributed', "factorization 'distributed'")
         call refuse_band(any(config%supports%lock_time < huge(1.0_dp)), 'lock_time')
         call refuse_band(any(config%contacts%partition%is_constant), 'constant multipliers')
         call refuse_band(any(config%contacts%slides_far()), "sliding = 'finite'")
         call refuse_band(any(config%materials%is_twisted), 'twist')
      end associate

   contains

      !> Refuses a band matrix where it does not go with something.
      subroutine refuse_band(is_given, what)
         logical, intent(in) :: is_given !! whether the deck has it
         character(*), intent(in) :: what !! its name

         call visitor%require(.not. (config%condensation%form == 'band' .and. is_given), 'condensation', &
            "condensation must be 'dense' or 'auto' with "//what)
      end subroutine refuse_band

   end subroutine describe_solver

   !> Refuses names that the mesh does not have, and keys of a plane body for a solid or the reverse, all in one error.
   subroutine check_names(config, mesh, error)
      type(config_t), intent(in) :: config !! the case
      type(mesh_t), intent(in) :: mesh !! its mesh
      type(error_t), allocatable, intent(out) :: error !! the names that are unknown, a line of text for each
      type(fault_list_t) :: faults
      integer :: i

      if (config%n_dim > 0 .and. config%n_dim /= size(mesh%coordinates, 1)) then
         call faults%add(0, config%file//':'//to_text(config%dimension_line)//': '//config%dimension_key// &
            body_words(config%n_dim)//', but the mesh has '//to_text(size(mesh%coordinates, 1))//' coordinates')
      end if
      do i = 1, size(config%materials)
         call check_name(.true., config%materials(i)%origin, config%materials(i)%region)
      end do
      do i = 1, size(config%supports)
         if (config%supports(i)%is_driven()) cycle
         call check_name(.false., config%supports(i)%origin, config%supports(i)%set)
      end do
      do i = 1, size(config%loads)
         ! The names of a rigid set are checked where it is made, those of a preload as a tie.
         if (config%loads(i)%target == load_on_motion) cycle
         call check_name(.false., config%loads(i)%origin, config%loads(i)%set)
         call check_name(.true., config%loads(i)%origin, config%loads(i)%region)
         associate (load => config%loads(i))
            if (config%accuracy%n_refinements == 0 .or. load%target /= load_on_nodes .or. len(load%set) == 0) cycle
            if (find_set(mesh%sets, load%set) == 0 .or. find_set(mesh%node_sets, load%set) > 0) cycle
            call faults%add(0, load%origin//"refinements: the force on every node of '"//load%set// &
               "' would grow with the number of nodes; give a traction")
         end associate
      end do
      do i = 1, size(config%contacts)
         call check_name(.false., config%contacts(i)%origin, config%contacts(i)%set)
         call check_name(.false., config%contacts(i)%origin, config%contacts(i)%pairing%against)
      end do
      do i = 1, size(config%ties)
         call check_name(.false., config%ties(i)%origin, config%ties(i)%set)
         call check_name(.false., config%ties(i)%origin, config%ties(i)%to)
      end do
      associate (probes => config%history%probes, n_dim => size(mesh%coordinates, 1))
         if (allocated(config%history%probes)) then
            if (modulo(size(probes), n_dim) > 0) call faults%add(0, config%history%probe_origin//'probe needs '// &
               trim(merge('three', 'two  ', n_dim == 3))//' coordinates for each node, found '// &
               to_text(size(probes))//' numbers')
         end if
      end associate
      if (faults%n > 0) call new_error(error, input_refused, faults%text())

   contains

      !> Records a set or a region that is unknown.
      subroutine check_name(is_region, origin, name)
         logical, intent(in) :: is_region !! whether it is a region, or else a set
         character(*), intent(in) :: origin !! position of the name, as messages begin
         character(*), intent(in) :: name !! the name; empty for none
         type(error_t), allocatable :: fault
         integer, allocatable :: sides(:, :), elements(:)

         if (len(name) == 0) return
         if (is_region) then
            if (find_set(mesh%regions, name) > 0) return
            call mesh%region_elements(name, elements, fault)
         else
            if (find_set(mesh%node_sets, name) > 0) return
            call mesh%set_sides(name, sides, fault)
         end if
         if (allocated(fault)) call faults%add(0, origin//fault%message)
      end subroutine check_name

   end subroutine check_names

end module amontons_config
