!> Keywords of the input format of Abaqus and CalculiX that are ignored, and those among them that matter.
module amontons_abaqus_keywords
   use amontons_file_model, only: use_loads, use_materials, use_names, use_supports
   use amontons_input_file, only: printable
   use amontons_raw_mesh, only: raw_mesh_t
   use amontons_text, only: counted
   implicit none (type, external)
   private

   public :: ignored_keywords_t

   !> Keywords that say what the body is made of.
   character(12), parameter :: material_keywords(*) = [character(12) :: 'material', 'elastic', 'density', 'expansion', &
      'solidsection']
   !> Keywords that hold nodes.
   character(12), parameter :: support_keywords(*) = [character(12) :: 'boundary']
   !> Keywords of loads.
   character(12), parameter :: load_keywords(*) = [character(12) :: 'cload', 'dload', 'dsload', 'temperature']
   !> Other keywords that change what a computation gives.
   character(33), parameter :: other_keywords(*) = [character(33) :: 'step', 'amplitude', 'transform', 'plastic', &
      'hyperelastic', 'hyperfoam', 'creep', 'viscoelastic', 'damping', 'contactpair', 'contact', 'contactinclusions', &
      'surfaceinteraction', 'surfacebehavior', 'friction', 'clearance', 'contactinterference', 'tie', 'equation', &
      'mpc', 'coupling', 'kinematic', 'distributing', 'rigidbody', 'spring', 'gap', 'mass', 'initialconditions', &
      'foundation', 'orientation', 'modelchange', 'pre-tensionsection', &
      'cflux', 'dflux', 'film', 'radiate', 'inertiarelief', 'basemotion', 'field', 'nodalthickness', 'usermaterial', &
      'deformationplasticity', 'cyclichardening', 'druckerprager', 'mohrcoulomb', 'concretedamagedplasticity', &
      'nocompression', 'notension', 'swelling', 'submodel', 'dashpot', 'embeddedelement', 'changefriction', &
      'changesurfacebehavior', 'changematerial', 'changesolidsection', 'cyclicsymmetrymodel', 'dynamic', 'frequency', &
      'complexfrequency', 'buckle', 'visco', 'modaldynamic', 'steadystatedynamics', 'heattransfer', &
      'coupledtemperature-displacement', 'uncoupledtemperature-displacement']
   !> Names of keywords are cut in messages.
   integer, parameter :: longest_name = 40
   !> Most keywords that are named.
   integer, parameter :: most_named = 40

   !> The keywords that are ignored.
   type :: ignored_keywords_t
      private
      integer :: n = 0 !! how many there are
      integer :: n_named = 0 !! how many different ones
      character(:), allocatable :: keys !! the different ones in small letters, each between line ends
      character(:), allocatable :: names !! the same as messages name them, ', ' before each
      character(:), allocatable :: warned !! those of them that matter
      logical :: is_readable(size(use_names)) = .false. !! whether some of them could be read
   contains
      procedure :: add => ignored_keywords_add
      procedure :: tell => ignored_keywords_tell
   end type ignored_keywords_t

contains

   !> Adds a keyword.
   pure subroutine ignored_keywords_add(self, keyword, line)
      class(ignored_keywords_t), intent(inout) :: self !! the keywords
      character(*), intent(in) :: keyword !! the keyword in small letters, without blanks
      character(*), intent(in) :: line !! the keyword line
      character(:), allocatable :: name
      integer :: last

      if (.not. allocated(self%keys)) then
         self%keys = achar(10)
         self%names = ''
         self%warned = ''
      end if
      self%n = self%n + 1
      if (index(self%keys, achar(10)//keyword//achar(10)) > 0 .or. self%n_named == most_named) return
      self%n_named = self%n_named + 1
      self%keys = self%keys//keyword//achar(10)
      last = index(line//',', ',') - 1
      ! What kind of step it is may matter, and of what the initial conditions are.
      if (keyword == 'step' .or. keyword == 'initialconditions') last = len(line)
      name = ', *'//capitals(printable(trim(line(:min(longest_name, last)))))
      self%names = self%names//name
      self%is_readable(use_materials) = self%is_readable(use_materials) .or. any(material_keywords == keyword)
      self%is_readable(use_supports) = self%is_readable(use_supports) .or. any(support_keywords == keyword)
      self%is_readable(use_loads) = self%is_readable(use_loads) .or. any(load_keywords == keyword)
      if (carries_physics(keyword)) self%warned = self%warned//name
   end subroutine ignored_keywords_add

   !> Whether a keyword changes what a computation gives.
   pure logical function carries_physics(keyword)
      character(*), intent(in) :: keyword !! the keyword in small letters, without blanks

      carries_physics = any(material_keywords == keyword) .or. any(support_keywords == keyword) .or. &
         any(load_keywords == keyword) .or. any(other_keywords == keyword)
   end function carries_physics

   !> Adds a note on what is ignored to a raw mesh, and a warning on what matters.
   pure subroutine ignored_keywords_tell(self, raw)
      class(ignored_keywords_t), intent(in) :: self !! the keywords
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      character(:), allocatable :: words
      integer :: i

      if (self%n == 0) return
      call raw%add_note(counted(self%n, 'keyword')//' ignored (not mesh data): '//self%names(3:))
      if (self%warned == '') return
      raw%warning = 'not read from the mesh file: '//self%warned(3:)
      words = ''
      do i = 1, size(use_names)
         if (self%is_readable(i)) words = words//", '"//trim(use_names(i))//"'"
      end do
      if (words /= '') raw%warning = raw%warning//'; give them in the deck, or &mesh use = '//words(3:)
   end subroutine ignored_keywords_tell

   !> A text with capital letters in the place of small ones.
   pure function capitals(text) result(upper)
      character(*), intent(in) :: text !! the text
      character(len(text)) :: upper
      integer :: i

      upper = text
      do i = 1, len(text)
         if (text(i:i) >= 'a' .and. text(i:i) <= 'z') upper(i:i) = achar(iachar(text(i:i)) - 32)
      end do
   end function capitals

end module amontons_abaqus_keywords
