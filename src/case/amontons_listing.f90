!> NAME.lst: the listing, which an engineer reads top to bottom and needs nothing else.
module amontons_listing
   use amontons_body, only: body_t
   use amontons_certificate, only: certificate_t
   use amontons_config, only: config_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_contact_table, only: contact_point_t, new_contact_point
   use amontons_error, only: error_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_kinds, only: dp
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_result, only: certificate_limit, result_t
   use amontons_text, only: to_text
   use amontons_timings, only: phase_names
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: write_listing

   character(*), parameter :: newline = new_line('a')

contains

   !> Writes the listing under its temporary name.
   subroutine write_listing(file, path, config, body, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      integer :: status

      call new_output_file(file, path, .false., error)
      if (allocated(error)) return
      write (file%unit, '(a)', iostat=status, advance='no') head_text(config)//model_text(config, body) &
         //loads_text(config)//solution_text(config, body, result)//zones_text(body, result) &
         //resultants_text(body, result)//certificate_text(config, result%certificate)
      if (status == 0) call write_points(file%unit, body, result, status)
      if (status == 0) write (file%unit, '(a)', iostat=status) times_text(result)
      call file%finish(status, error)
   end subroutine write_listing

   !> Program, case and deck.
   pure function head_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      text = 'Amontons '//version//': plane contact with Coulomb friction by the dual method'//newline//newline// &
         line('Case', config%name)//line('Title', config%title)//line('Deck', config%file)
   end function head_text

   !> Mesh, material, supports and contact sets.
   function model_text(config, body) result(text)
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      character(:), allocatable :: text
      integer :: i

      associate (r => config%rectangle, material => config%material)
         text = heading('Model')// &
            line('Rectangle', short(r%size(1))//' x '//short(r%size(2))//', '//to_text(r%cells(1))//' x '// &
            to_text(r%cells(2))//' cells of '//r%element)// &
            line('Nodes, elements', to_text(body%mesh%n_nodes)//', '//to_text(body%mesh%n_elements))// &
            line('Unknowns', to_text(body%dof_map%n_dofs)//', of them '//to_text(body%dof_map%n_trailing)// &
            ' on the contact line')// &
            line('Material', material%hypothesis//', Young '//short(material%young)//', Poisson '// &
            short(material%poisson)//', thickness '//short(material%thickness))
      end associate
      do i = 1, size(config%supports)
         text = text//line('Support', support_text(config, i))
      end do
      do i = 1, size(config%contacts)
         associate (contact => config%contacts(i))
            text = text//line('Contact', "set '"//contact%set//"', friction "//short(contact%friction)// &
               ', plane through '//pair(contact%point)//' with normal '//pair(contact%normal))
         end associate
      end do
      text = text//line('Contact points', to_text(body%zone%n_points))//notes_text(body)
   end function model_text

   !> What a support holds.
   pure function support_text(config, i) result(text)
      type(config_t), intent(in) :: config !! the case
      integer, intent(in) :: i !! which support
      character(:), allocatable :: text
      character(2), parameter :: keys(4) = ['ux', 'uy', 'un', 'ut']
      integer :: k

      associate (support => config%supports(i))
         if (len(support%set) > 0) then
            text = "set '"//support%set//"'"
         else
            text = 'point '//pair(support%point)
         end if
         do k = 1, 4
            if (support%is_held(k)) text = text//', '//keys(k)//' = '//short(support%displacement(k))
         end do
      end associate
   end function support_text

   !> What the reader must know of the contact points: what supports take over, overlap, free motions.
   pure function notes_text(body) result(text)
      type(body_t), intent(in) :: body !! the body
      character(:), allocatable :: text
      integer :: i

      text = ''
      associate (zone => body%zone)
         if (body%motions%n_free > 0) text = text//line('Note', 'the supports leave '//to_text(body%motions%n_free)// &
            ' rigid motion(s) free; contact alone holds the body there')
         do i = 1, size(zone%held_node)
            text = text//line('Note', 'the node at '//pair(body%mesh%coordinates(:, zone%held_node(i)))// &
               ' is no contact point: supports hold it')
         end do
         do i = 1, zone%n_points
            if (zone%is_guided(i)) text = text//line('Note', 'the node at '// &
               pair(body%mesh%coordinates(:, zone%node(i)))//' cannot slide: a support bears its tangential force')
         end do
         if (any(zone%gap < 0.0_dp)) text = text//line('Note', 'the body overlaps the obstacle by up to '// &
            short(-minval(zone%gap))//' at the start')
      end associate
   end function notes_text

   !> The loads.
   pure function loads_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(config%loads)
         associate (load => config%loads(i))
            if (len(load%set) > 0) then
               text = text//line('Load', "set '"//load%set//"', traction "//pair(load%traction)//', pressure '// &
                  short(load%pressure))
            else
               text = text//line('Load', 'body force '//pair(load%body_force))
            end if
         end associate
      end do
   end function loads_text

   !> How the contact problem was solved.
   function solution_text(config, body, result) result(text)
      type(config_t), intent(in) :: config !! the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (solution => result%solution)
         text = heading('Solution')//line('Method', method_text(config))
         text = text//line('Factorisation', factorization_text(body, result))
         if (allocated(result%started_from)) text = text//line('Started from', 'case '//result%started_from)
         if (solution%is_converged) then
            text = text//line('Converged', 'yes, in '//to_text(solution%n_iterations)//' iterations')
         else
            text = text//line('Converged', 'NO: stopped after '//to_text(solution%n_iterations)// &
               ' iterations; the results below are not the solution')
         end if
         if (solution%is_at_rest .and. .not. solution%is_converged) text = text// &
            line('Note', 'the forces came to rest at a wrong answer: they do not fulfil the contact law')
         if (result%method_error >= 0.0_dp) text = text//line('Error of method', scientific(result%method_error)// &
            ' of the largest contact force, against the exact solution')
         text = text//line('Residual', scientific(solution%residual)//', tolerance ' &
            //scientific(config%method%tolerance))//history_text(solution)
      end associate
   end function solution_text

   !> The factorisation in use, its size, and the case it was made for.
   function factorization_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (factorization => body%condensation%factorization)
         text = factorization%name()//', '//to_text(factorization%n_factor_entries())//' entries'
      end associate
      if (allocated(result%shared_with)) text = text//', shared with case '//result%shared_with
   end function factorization_text

   !> The residual after each iteration; of many iterations about twenty.
   pure function history_text(solution) result(text)
      type(contact_solution_t), intent(in) :: solution !! the solution and its record
      character(:), allocatable :: text
      integer, parameter :: n_lines = 20
      integer :: i, stride

      text = line('Residual history', 'iteration, residual')
      stride = max(1, solution%n_iterations/n_lines)
      do i = 1, solution%n_iterations
         if (i /= 1 .and. i /= solution%n_iterations .and. mod(i, stride) /= 0) cycle
         text = text//line('', right(to_text(i), len('iteration'))//'  '//scientific(solution%history(i)))
      end do
   end function history_text

   !> The method with the options that it uses.
   pure function method_text(config) result(text)
      type(config_t), intent(in) :: config !! the case
      character(:), allocatable :: text

      text = config%method%method
      if (text == 'splitting') text = text//', variant '//config%method%variant
      if (text == 'psor') text = text//', omega '//short(config%method%omega)//', '//config%method%space//' space'
   end function method_text

   !> Counts and lengths of the open, sliding and sticking parts.
   pure function zones_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (status => result%solution%status, lengths => result%lengths)
         text = heading('Contact line')// &
            line('Points', to_text(body%zone%n_points)//': '//to_text(count(status == open_point))//' open, '// &
            to_text(count(status == slip_plus))//' slip+, '//to_text(count(status == slip_minus))//' slip-, '// &
            to_text(count(status == stick_point))//' stick')// &
            line('Separated length', short(lengths%separated))// &
            line('Sliding length', short(lengths%sliding))// &
            line('Sticking length', short(lengths%sticking))
      end associate
   end function zones_text

   !> Resultants of all forces.
   pure function resultants_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (certificate => result%certificate, force => result%solution%force, m => body%zone%n_points)
         text = heading('Resultants')// &
            line('Loads', pair(certificate%load))// &
            line('Support reactions', pair(certificate%reaction))// &
            line('Contact forces', pair(certificate%contact))// &
            line('Normal, tangential', short(sum(force(:m)))//', '//short(sum(force(m + 1:))))// &
            line('Strain energy', short(certificate%strain_energy))// &
            line('Work of friction', short(certificate%dissipation))
      end associate
   end function resultants_text

   !> The certificate in words.
   pure function certificate_text(config, certificate) result(text)
      type(config_t), intent(in) :: config !! the case
      type(certificate_t), intent(in) :: certificate !! the certificate
      character(:), allocatable :: text
      real(dp) :: limit

      limit = certificate_limit(config%method%tolerance)
      text = heading('Certificate on the full model (violations, each over its natural scale)')
      call check('Equilibrium', certificate%equilibrium)
      call check('Penetration', certificate%penetration)
      call check('Tension', certificate%tension)
      call check('Friction excess', certificate%friction_excess)
      call check('Complementarity', certificate%complementarity)
      call check('Wrong dissipation', certificate%wrong_dissipation)
      call check('Resultant', certificate%resultant)
      call check('Moment', certificate%moment)
      call check('Energy balance', certificate%energy)
      text = text//line('Verdict', trim(merge('passed', 'FAILED', certificate%largest() <= limit))// &
         ': every violation must be at most '//scientific(limit))

   contains

      !> Adds a line on one violation.
      pure subroutine check(name, value)
         character(*), intent(in) :: name !! what is checked
         real(dp), intent(in) :: value !! the violation [-]

         text = text//line(name, scientific(value)//trim(merge('        ', '  FAILED', value <= limit)))
      end subroutine check

   end function certificate_text

   !> Writes the table of contact points.
   subroutine write_points(unit, body, result, status)
      integer, intent(in) :: unit !! the unit to write to
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      integer, intent(out) :: status !! status of the last write statement
      type(contact_point_t) :: point
      integer :: p

      write (unit, '(a, a7, 8a13, 2x, a)', iostat=status) &
         heading('Contact points (forces and stresses: compression and shear along the slip positive)'), 'point', &
         'x', 'y', 'gap', 'slip', 'normal force', 'tang. force', 'norm. stress', 'tang. stress', 'status'
      if (status /= 0) return
      do p = 1, body%zone%n_points
         call new_contact_point(point, body, result, p)
         write (unit, '(i7, 8es13.5, 2x, a)', iostat=status) p, point%position, point%gap, point%slip, &
            point%normal_force, point%tangential_force, point%normal_stress, point%tangential_stress, point%status
         if (status /= 0) return
      end do
   end subroutine write_points

   !> Where the time went.
   pure function times_text(result) result(text)
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      character(16) :: seconds
      integer :: i

      text = heading('Time [s]')
      do i = 1, size(phase_names) - 1
         write (seconds, '(f10.4)') result%timings%seconds(i)
         text = text//line(trim(phase_names(i)), trim(seconds))
      end do
      text = text//newline//'End of listing'
   end function times_text

   !> A heading with the line above it empty.
   pure function heading(title) result(text)
      character(*), intent(in) :: title !! the title
      character(:), allocatable :: text

      text = newline//title//newline//repeat('-', len(title))//newline
   end function heading

   !> A line of the listing: a label and what belongs to it.
   pure function line(label, value) result(text)
      character(*), intent(in) :: label !! the label
      character(*), intent(in) :: value !! what belongs to it
      character(:), allocatable :: text
      character(20) :: column

      column = label
      text = '  '//column//value//newline
   end function line

   !> Two numbers with six digits.
   pure function pair(values) result(text)
      real(dp), intent(in) :: values(2) !! the numbers
      character(:), allocatable :: text

      text = '('//short(values(1))//', '//short(values(2))//')'
   end function pair

   !> A number with at most seven digits, for reading.
   pure function short(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text
      character(16) :: buffer
      real(dp) :: rounded

      write (buffer, '(es15.6e3)') value
      read (buffer, '(es15.6e3)') rounded
      text = to_text(rounded)
   end function short

   !> A number in scientific form with three digits.
   pure function scientific(value) result(text)
      real(dp), intent(in) :: value !! the number
      character(:), allocatable :: text
      character(12) :: buffer

      write (buffer, '(es10.2e3)') value
      text = trim(adjustl(buffer))
   end function scientific

   !> A text moved to the right end of a column.
   pure function right(value, width) result(text)
      character(*), intent(in) :: value !! the text
      integer, intent(in) :: width !! width of the column
      character(:), allocatable :: text

      text = repeat(' ', max(0, width - len(value)))//value
   end function right

end module amontons_listing
