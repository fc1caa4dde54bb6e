"""Meshes of a block much larger than its contact zone: even cells in the core, growing ones out to the far sides."""
from math import hypot, log

from mapped_mesh import mapped_mesh
from mapped_solid import mapped_solid

# Each cell outside of the core is longer than the one before by this factor when the core's cells measure COARSE, or
# what is given; when they are halved, so are those outside.
GROWTH, COARSE = 1.5, 1/8


def stations(core, length, h, coarse=COARSE):
    """Coordinates of the cells' ends from 0 on: cells h up to the core's end, then growing ones up to the length."""
    growth = GROWTH**(h/coarse)
    even = [core*i/round(core/h) for i in range(round(core/h) + 1)]
    number = round(log(1 + (length - core)*(growth - 1)/(h*growth))/log(growth))
    steps = [growth**k for k in range(1, number + 1)]
    scale = (length - core)/sum(steps)
    return even + [core + scale*sum(steps[:k]) for k in range(1, number)] + [length]


def graded_block(element, h, size, core, is_mirrored=False, shape=None):
    """The text of a mesh file: 0 <= x <= size, or |x| <= size where it is mirrored, and 0 <= y <= size.

    The cells measure h by h where |x| <= core and y is at most a third of that. With a shape the block is one below,
    -size <= y <= 0, its upper side lowered by shape(x), and its far side stays.
    """
    x, y = stations(core, size, h), stations(core/3, size, h)
    if is_mirrored:
        x = [-place for place in x[:0:-1]] + x

    def mapping(s, t):
        if shape is None:
            return between(x, s), between(y, t)
        across, down = between(x, s), between(y, 1 - t)
        return across, -down - shape(across)*(1 - down/size)
    return mapped_mesh((len(x) - 1, len(y) - 1), element, mapping)


def between(places, share):
    """The place at a share of a list: one of its places, or the middle between two of them."""
    place, is_middle = divmod(round(2*share*(len(places) - 1)), 2)
    return (places[place] + places[place + 1])/2 if is_middle else places[place]


def graded_solid(element, h, size, core, mirrors=0, shape=None):
    """The text of a mesh file of solids: 0 <= x, y, z <= size, or |x| <= size, or |x|, |y| <= size with two mirrors.

    The cells measure h where x and y are at most the core and z a third of it. Their faces on the core are the set
    `bottom`, the rest of that side is `far`. With a shape the block is one below, -size <= z <= 0, whose `top` is
    lowered by shape(r).
    """
    half, up = stations(core, size, h), stations(core/3, size, h)
    along, across = ([-x for x in half[:0:-1]] + half if mirrors >= count else half for count in (1, 2))

    def mapping(r, s, t):
        x, y = between(along, r), between(across, s)
        if shape is None:
            return x, y, between(up, t)
        down = between(up, 1 - t)
        return x, y, -down - shape(hypot(x, y))*(1 - down/size)

    def set_of(side, place):
        reach = max(abs(between(along, place[0])), abs(between(across, place[1])))
        return "far" if side == ("bottom" if shape is None else "top") and reach > core else side
    return mapped_solid((len(along) - 1, len(across) - 1, len(up) - 1), element, mapping, set_of)
