!> The patches of a body whose stresses are recovered: for each corner node and material the elements around it, and the
!> coordinates that a polynomial is fitted in. Loads do not matter: what is found once serves all cases of a body.
module amontons_patch_table
   use amontons_coloring, only: worth_threads
   use amontons_elasticity, only: element_geometry_t, new_element_geometry
   use amontons_element, only: n_corners, n_sampling_points
   use amontons_incidence, only: incidence_t, new_incidence
   use amontons_integer_list, only: integer_list_t
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_patch_frame, only: frame_t, is_linear, n_kind_terms, place_patch, samples_t
   implicit none (type, external)
   private

   public :: block_size, new_patch_table, patch_table_t

   !> So many elements in a row are a block: the polynomials of all patches would take more memory than anything else
   !> but a factor, those of a block stay in a cache, and few elements share patches with those of another block.
   integer, parameter :: block_size = 8192

   !> The patches.
   type :: patch_table_t
      integer, allocatable :: of_corner(:)
         !! patch of each corner of the elements, by its place in the list of its block; placed as `node` of the mesh
      integer, allocatable :: block_start(:) !! where the list of each block of elements begins in `listed` (blocks + 1)
      integer, allocatable :: listed(:) !! the patches that the elements of each block have corners in
      integer, allocatable :: node(:) !! node of each patch
      integer, allocatable :: start(:) !! where the elements of each patch begin in `element` (patches + 1)
      integer, allocatable :: element(:) !! the elements of the patches, first those that meet at its node
      integer, allocatable :: n_near(:) !! how many elements of each patch meet at its node
      type(frame_t), allocatable :: frame(:) !! coordinates and terms of the patches
      logical :: is_linear = .false. !! whether no polynomial has terms of the second order
      type(samples_t) :: samples !! the points whose stresses are fitted
   contains
      procedure :: at_corner => patch_table_at_corner
   end type patch_table_t

   !> Some patches, one after the other.
   type :: chunk_t
      type(integer_list_t) :: elements !! their elements
   end type chunk_t

contains

   !> Finds the patches of a mesh.
   subroutine new_patch_table(table, mesh, materials)
      type(patch_table_t), intent(out) :: table !! the patches
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      ! So many that lists of their elements are long, and threads have enough of them.
      integer, parameter :: chunk_size = 4096
      type(incidence_t) :: incidence
      type(chunk_t), allocatable :: chunks(:)
      integer, allocatable :: first_element(:)
      integer :: first, i, k, n

      call new_samples(table%samples, mesh, materials)
      call new_incidence(incidence, mesh)
      call number_patches(table%of_corner, table%node, first_element, mesh, materials, incidence)
      deallocate (incidence%corner)
      call list_blocks(table, mesh)
      n = size(table%node)
      allocate (table%frame(n), table%n_near(n), table%start(n + 1), chunks((n - 1)/chunk_size + 1))
      !$omp parallel do default(none) schedule(dynamic) if (mesh%n_elements >= worth_threads) private(k, first) &
      !$omp shared(table, mesh, materials, incidence, chunks, first_element, n)
      do i = 1, size(chunks)
         do k = (i - 1)*chunk_size + 1, min(n, i*chunk_size)
            first = chunks(i)%elements%n
            call add_patch(table, chunks(i)%elements, k, first_element(k), mesh, materials, incidence)
            table%start(k + 1) = chunks(i)%elements%n - first
         end do
      end do
      !$omp end parallel do
      table%start(1) = 1
      do k = 1, n
         table%start(k + 1) = table%start(k) + table%start(k + 1)
      end do
      allocate (table%element(table%start(n + 1) - 1))
      do i = 1, size(chunks)
         first = table%start((i - 1)*chunk_size + 1)
         table%element(first:first + chunks(i)%elements%n - 1) = chunks(i)%elements%item(:chunks(i)%elements%n)
         deallocate (chunks(i)%elements%item)
      end do
      table%is_linear = all(is_linear(table%frame))
   end subroutine new_patch_table

   !> Places the points of the elements where their stresses are most accurate.
   subroutine new_samples(samples, mesh, materials)
      type(samples_t), intent(out) :: samples !! the points
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(element_geometry_t) :: geometry
      integer :: i

      allocate (samples%start(mesh%n_elements + 1))
      samples%start(1) = 1
      do i = 1, mesh%n_elements
         samples%start(i + 1) = samples%start(i) + n_sampling_points(mesh%element_kind(i))
      end do
      allocate (samples%position(2, samples%start(mesh%n_elements + 1) - 1))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(geometry) shared(samples, mesh, materials)
      do i = 1, mesh%n_elements
         call new_element_geometry(geometry, mesh, i, materials%list(materials%of_element(i)), &
            n_sampling_points(mesh%element_kind(i)))
         samples%position(:, samples%start(i):samples%start(i + 1) - 1) = geometry%position(:, :geometry%n_points)
      end do
      !$omp end parallel do
   end subroutine new_samples

   !> Numbers the patches: one for each corner node and each material there.
   subroutine number_patches(of_corner, node, element, mesh, materials, incidence)
      integer, allocatable, intent(out) :: of_corner(:) !! patch of each corner, placed as `node` of the mesh
      integer, allocatable, intent(out) :: node(:) !! node of each patch
      integer, allocatable, intent(out) :: element(:) !! first element of each patch
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      integer :: n, i, k, same

      allocate (of_corner(size(mesh%node)), source=0)
      n = 0
      do i = 1, mesh%n_nodes
         do k = incidence%start(i), incidence%start(i + 1) - 1
            do same = incidence%start(i), k
               if (materials%of_element(incidence%element(same)) &
                  == materials%of_element(incidence%element(k))) exit
            end do
            if (same == k) then
               n = n + 1
               of_corner(incidence%corner(k)) = n
            else
               of_corner(incidence%corner(k)) = of_corner(incidence%corner(same))
            end if
         end do
      end do
      allocate (node(n), element(n))
      do i = mesh%n_nodes, 1, -1
         do k = incidence%start(i + 1) - 1, incidence%start(i), -1
            associate (patch => of_corner(incidence%corner(k)))
               node(patch) = i
               element(patch) = incidence%element(k)
            end associate
         end do
      end do
   end subroutine number_patches

   !> Lists the patches of each block.
   pure subroutine list_blocks(table, mesh)
      type(patch_table_t), intent(inout) :: table !! the patches, those of the corners by their numbers; gains the lists
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(integer_list_t) :: list
      integer, allocatable :: place(:)
      integer :: block, element, i, before

      allocate (place(size(table%node)), source=0)
      allocate (table%block_start((mesh%n_elements - 1)/block_size + 2))
      table%block_start(1) = 1
      do block = 1, size(table%block_start) - 1
         before = list%n
         do element = (block - 1)*block_size + 1, min(mesh%n_elements, block*block_size)
            do i = mesh%node_start(element), mesh%node_start(element) + n_corners(mesh%element_kind(element)) - 1
               associate (patch => table%of_corner(i))
                  if (place(patch) <= before) then
                     call list%append(patch)
                     place(patch) = list%n
                  end if
                  patch = place(patch) - before
               end associate
            end do
         end do
         table%block_start(block + 1) = list%n + 1
      end do
      table%listed = list%items()
   end subroutine list_blocks

   !> Adds a patch. One with too few samples for its polynomial grows by the elements around it; terms that no growth
   !> determines are left out.
   pure subroutine add_patch(table, list, patch, first_element, mesh, materials, incidence)
      type(patch_table_t), intent(inout) :: table !! the patches; this one gains its coordinates
      type(integer_list_t), intent(inout) :: list !! elements of patches; gains those of this one
      integer, intent(in) :: patch !! number of the patch
      integer, intent(in) :: first_element !! its first element
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      integer, parameter :: most_growths = 2
      integer :: first, growth
      logical :: is_determined

      first = list%n + 1
      associate (frame => table%frame(patch), n_near => table%n_near(patch))
         frame%n_terms = n_kind_terms(mesh%element_kind(first_element))
         call add_elements_at(list, first, table%node(patch), materials, incidence, materials%of_element(first_element))
         n_near = list%n - first + 1
         do growth = 0, most_growths
            if (growth > 0) call grow_patch(list, first, mesh, materials, incidence)
            call place_patch(frame, is_determined, mesh, table%samples, list%item(first:list%n), n_near)
            if (is_determined) return
         end do
         do while (.not. is_determined)
            frame%n_terms = merge(1, frame%n_terms - 3, frame%n_terms == 3)
            call place_patch(frame, is_determined, mesh, table%samples, list%item(first:list%n), n_near)
         end do
      end associate
   end subroutine add_patch

   !> Adds the elements of a material at a node that are not in a patch yet.
   pure subroutine add_elements_at(list, first, node, materials, incidence, material)
      type(integer_list_t), intent(inout) :: list !! elements of patches, those of this one last
      integer, intent(in) :: first !! where these begin
      integer, intent(in) :: node !! the node
      type(materials_t), intent(in) :: materials !! the materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      integer, intent(in) :: material !! number of the material
      integer :: k

      do k = incidence%start(node), incidence%start(node + 1) - 1
         associate (element => incidence%element(k))
            if (materials%of_element(element) /= material) cycle
            if (list%n >= first) then
               if (any(list%item(first:list%n) == element)) cycle
            end if
            call list%append(element)
         end associate
      end do
   end subroutine add_elements_at

   !> Adds the elements around a patch.
   pure subroutine grow_patch(list, first, mesh, materials, incidence)
      type(integer_list_t), intent(inout) :: list !! elements of patches, those of this one last
      integer, intent(in) :: first !! where these begin
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      integer :: i, k, element

      do i = first, list%n
         ! A copy: the list may move to a larger place as it grows.
         element = list%item(i)
         do k = mesh%node_start(element), mesh%node_start(element) + n_corners(mesh%element_kind(element)) - 1
            call add_elements_at(list, first, mesh%node(k), materials, incidence, materials%of_element(element))
         end do
      end do
   end subroutine grow_patch

   !> The patch of a corner of an element.
   pure integer function patch_table_at_corner(self, element, corner) result(patch)
      class(patch_table_t), intent(in) :: self !! the patches
      integer, intent(in) :: element !! the element
      integer, intent(in) :: corner !! the corner, placed as `node` of the mesh

      patch = self%listed(self%block_start((element - 1)/block_size + 1) - 1 + self%of_corner(corner))
   end function patch_table_at_corner

end module amontons_patch_table
