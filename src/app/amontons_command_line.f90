!> The command line: options and decks.
module amontons_command_line
   use amontons_deck, only: new_setting, setting_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_system, only: file_name_t
   use amontons_text, only: nearest_word, read_integer
   implicit none (type, external)
   private

   public :: command_line_t, read_command_line

   !> Options, as they are written.
   character(16), parameter :: option_names(*) = [character(16) :: '--output', '--set', '--refine', '--check', &
      '--quiet', '--progress', '--threads', '--skip-unchanged', '--reduced', '--write-reduced', '--all-solutions', &
      '--verify', '--reference', '--help', '--version']
   !> Short forms of the options, in the order of `option_names`.
   character(2), parameter :: short_names(size(option_names)) = [character(2) :: '-o', '', '', '', '-q', '', '-t', '', &
      '', '', '', '', '', '-h', '']
   !> Options that take a value.
   character(16), parameter :: valued_names(*) = [character(16) :: '--output', '--set', '--refine', '--threads']
   !> Names that other programs use for each option, separated by blanks.
   character(24), parameter :: other_names(*) = [character(24) :: '--outdir --dir -d', '--param --define -D', '', &
      '--dry-run --validate', '--silent -s', '--verbose', '--nthreads --jobs -j -n', '', '', '', '', '', '--keys', '', &
      '-v -V']

   !> The options and decks given on the command line.
   type :: command_line_t
      type(file_name_t), allocatable :: decks(:) !! names of the decks, in their order
      type(setting_t), allocatable :: settings(:) !! settings that replace values of the decks
      character(:), allocatable :: output !! output directory
      integer :: n_threads = 0 !! number of threads; 0 for the value of OMP_NUM_THREADS, or all cores
      logical, private :: is_given(size(option_names)) = .false. !! whether each option without a value was given
   contains
      procedure :: asks => command_line_asks
   end type command_line_t

contains

   !> Reads the command line of this process.
   subroutine read_command_line(command_line, error)
      type(command_line_t), intent(out) :: command_line !! the options and decks
      type(error_t), allocatable, intent(out) :: error !! an unknown option, or a value that is missing or wrong
      character(:), allocatable :: word
      integer :: i, n_decks
      logical :: only_decks

      allocate (command_line%decks(command_argument_count()), command_line%settings(0))
      only_decks = .false.
      n_decks = 0
      i = 0
      do while (i < command_argument_count())
         i = i + 1
         word = argument(i)
         if (only_decks .or. index(word, '-') /= 1 .or. word == '-') then
            n_decks = n_decks + 1
            command_line%decks(n_decks)%text = word
         else if (word == '--') then
            only_decks = .true.
         else
            call read_option(command_line, word, i, error)
            if (allocated(error)) return
         end if
      end do
      command_line%decks = command_line%decks(:n_decks)
      if (command_line%asks('--help') .or. command_line%asks('--version') .or. command_line%asks('--reference')) return
      call check_decks(command_line, error)
      if (.not. allocated(command_line%output)) command_line%output = '.'
   end subroutine read_command_line

   !> Checks that at least one deck, directory or reduced problem is given and that the options are compatible.
   subroutine check_decks(command_line, error)
      type(command_line_t), intent(in) :: command_line !! the options and decks
      type(error_t), allocatable, intent(out) :: error !! no deck, options that do not go together
      character(:), allocatable :: expected
      integer :: i

      expected = 'a deck'
      if (command_line%asks('--reduced')) expected = 'the file of a reduced problem'
      if (command_line%asks('--verify')) expected = 'a directory with results'
      if (size(command_line%decks) == 0) then
         call new_error(error, input_refused, 'amontons: expected '//expected//'; try amontons --help')
      else if (command_line%asks('--verify') .and. any([allocated(command_line%output), command_line%asks('--check'), &
         command_line%asks('--reduced'), command_line%asks('--write-reduced'), command_line%asks('--all-solutions'), &
         command_line%asks('--skip-unchanged'), command_line%asks('--progress'), size(command_line%settings) > 0])) then
         call new_error(error, input_refused, 'amontons: --verify takes directories with results; of the other '// &
            'options only --quiet and --threads go with it')
      else if (command_line%asks('--skip-unchanged') .and. (command_line%asks('--write-reduced') .or. &
         command_line%asks('--all-solutions'))) then
         call new_error(error, input_refused, 'amontons: --skip-unchanged does not go with --write-reduced or '// &
            '--all-solutions')
      else if (command_line%asks('--reduced') .and. any([(command_line%decks(i)%text == '-', &
         i=1, size(command_line%decks))])) then
         call new_error(error, input_refused, 'amontons: --reduced takes files; standard input (-) can only be a deck')
      end if
   end subroutine check_decks

   !> Reads one option and, if it takes one, its value: `--output DIR` or `--output=DIR`.
   subroutine read_option(command_line, word, i, error)
      type(command_line_t), intent(inout) :: command_line !! gains what the option asks for
      character(*), intent(in) :: word !! the option as written
      integer, intent(inout) :: i !! its place on the command line; moved on where the next word is its value
      type(error_t), allocatable, intent(out) :: error !! an unknown option, or a value that is missing or wrong
      character(:), allocatable :: name, value, expected
      type(setting_t) :: setting
      integer :: at_equals, option, n_refinements
      logical :: ok

      at_equals = index(word//'=', '=')
      name = word(:at_equals - 1)
      option = findloc(option_names == name .or. (short_names == name .and. short_names /= ''), .true., dim=1)
      if (option == 0) then
         call new_error(error, input_refused, "amontons: unknown option '"//name//"'"//suggestion(name))
         return
      end if
      if (all(valued_names /= option_names(option))) then
         command_line%is_given(option) = .true.
         if (at_equals <= len(word)) call new_error(error, input_refused, 'amontons: '//name//' takes no value')
         return
      end if
      if (at_equals <= len(word)) then
         value = word(at_equals + 1:)
      else
         i = i + 1
         value = argument(i)
      end if
      select case (option_names(option))
      case ('--output')
         expected = 'the name of a directory'
         command_line%output = value
         ok = len(value) > 0
      case ('--refine')
         expected = 'a number of at least 2'
         call read_integer(value, n_refinements, ok)
         ok = ok .and. n_refinements > 1
         if (ok) call new_setting(setting, 'accuracy.refinements='//value, error)
         if (ok) command_line%settings = [command_line%settings, setting]
      case ('--set')
         call new_setting(setting, value, error)
         if (allocated(error)) error%message = 'amontons: --set: '//error%message
         if (.not. allocated(error)) command_line%settings = [command_line%settings, setting]
         return
      case default
         expected = 'a number of at least 1'
         call read_integer(value, command_line%n_threads, ok)
         ok = ok .and. command_line%n_threads > 0
      end select
      if (.not. ok) call new_error(error, input_refused, 'amontons: '//name//' expects '//expected//", found '"// &
         value//"'")
   end subroutine read_option

   !> Whether an option without a value was given.
   pure logical function command_line_asks(self, option) result(asks)
      class(command_line_t), intent(in) :: self !! the options and decks
      character(*), intent(in) :: option !! the option

      asks = any(self%is_given .and. option_names == option)
   end function command_line_asks

   !> The hint in the message about an unknown option: the option that other programs call by this name, a similar one,
   !> or the only one that begins with it.
   pure function suggestion(name) result(text)
      character(*), intent(in) :: name !! the unknown option
      character(:), allocatable :: text
      logical :: begins(size(option_names))
      integer :: i

      text = ''
      do i = 1, size(option_names)
         if (index(' '//trim(other_names(i))//' ', ' '//name//' ') > 0) text = trim(option_names(i))
      end do
      if (text == '') text = nearest_word(name, option_names)
      begins = [(index(option_names(i), '--'//trim(name(verify(name//'.', '-'):))) == 1, i=1, size(option_names))]
      if (len(text) == 0 .and. count(begins) == 1) text = trim(option_names(findloc(begins, .true., dim=1)))
      if (len(text) > 0) then
         text = '; did you mean '//text//'?'
      else
         text = '; try amontons --help'
      end if
   end function suggestion

   !> A word of the command line; empty past the end.
   function argument(i) result(word)
      integer, intent(in) :: i !! its place, from 1
      character(:), allocatable :: word
      integer :: length

      length = 0
      if (i <= command_argument_count()) call get_command_argument(i, length=length)
      allocate (character(length) :: word)
      if (length > 0) call get_command_argument(i, word)
   end function argument

end module amontons_command_line
