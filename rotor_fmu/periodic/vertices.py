"""The line of a branch: its points with the bifurcations between them, stable and unstable."""

from typing import NamedTuple

from ..model.periodic.branch import Bifurcation, Branch, Solution


class Vertex(NamedTuple):
    """A point of a branch or a bifurcation, and whether the motions that follow it are stable."""

    motion: Solution | Bifurcation
    is_stable: bool


def vertices(branch: Branch) -> list[Vertex]:
    """Return the points of a branch with the bifurcations between them, in their order."""
    result = list[Vertex]()
    for i, point in enumerate(branch.points):
        passed = [b for b in branch.bifurcations if b.behind == i - 1]
        if passed:
            both = result[-1].is_stable and point.is_stable
            result += [Vertex(b, both) for b in passed[:-1]]
            result.append(Vertex(passed[-1], point.is_stable))
        result.append(Vertex(point, point.is_stable))
    return result


def pieces(branch: Branch) -> list[tuple[list[Solution | Bifurcation], bool]]:
    """Return the stretches of a branch that are all stable or all not, each up to the first motion
    of the next one, and which."""
    result = list[tuple[list[Solution | Bifurcation], bool]]()
    for motion, is_stable in vertices(branch):
        if not result or result[-1][1] != is_stable:
            if result:
                result[-1][0].append(motion)
            result.append(([], is_stable))
        result[-1][0].append(motion)
    return result
