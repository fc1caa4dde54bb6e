"""Meshes of a block much larger than its contact zone: even cells in the core, growing ones out to the far sides."""
from math import log

from mapped_mesh import mapped_mesh

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
