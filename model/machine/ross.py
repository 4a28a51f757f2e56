"""Rotors saved by ROSS (petrobras/ross) -> the tables of a machine file, without ROSS.

One table an element, keyed `{Class}_{tag}`; SI units, nodes from 0, x and y transverse. Elements of
one `n` are layers. A bearing's `n_link` beyond the shaft is a pedestal: a point mass on a second
bearing to ground; here a housing. An element that cannot be imported is an error that names it.
"""

import json
import tomllib
from collections.abc import Mapping
from typing import Any, NamedTuple

from ..errors import printable
from ..quantities import QuantityError
from .ross_element import Element
from .ross_shaft import sections_of
from .table_reader import a_table

_SHAFT, _DISC, _MASS = "ShaftElement", "DiskElement", "PointMass"
_BEARINGS = {"BearingElement": "linear_bearing", "SealElement": "seal"}
# those that ROSS computes, and saves with their coefficients
_COMPUTED = (
    *("BallBearingElement", "RollerBearingElement", "MagneticBearingElement"),
    *("BearingFluidFlow", "CylindricalBearing", "PlainJournal", "TiltingPad", "SqueezeFilmDamper"),
    *("LabyrinthSeal", "HolePatternSeal", "HybridSeal"),
)
# a key of each of those that ROSS 2.3 saves under the name of a bearing by coefficients: a magnetic
# bearing, a plain journal bearing, tilting pads
_CONTROLLED = "kp_pid"
_COMPUTED_BY = (_CONTROLLED, "n_pad", "pivot_angle")
_COEFFICIENTS = tuple(f"{of}{axes}" for of in "kc" for axes in ("xx", "xy", "yx", "yy"))
_MASSES = ("mxx", "mxy", "myx", "myy")
_NOT_LATERAL = ("kzz", "czz", "mzz", "radial_clearance", "seal_leakage")
_OF_BEARINGS = ("n", "n_link", "frequency", "speed", *_COEFFICIENTS, *_MASSES, *_NOT_LATERAL)
_HEAD = ("ross_version", "parameters", "_note")
_SPEEDS = {"min_w": "minimum_speed", "rated_w": "rated_speed", "max_w": "maximum_continuous_speed"}
_MODAL = ("modal_damping_ratio", "default_damping_ratio")
_ORIGINS = {"operation": "parameters", "shaft.eta_v": "beta", "shaft.mass_damping": "alpha"}


class Imported(NamedTuple):
    """A machine from ROSS: the tables of a machine file, notes on the import, and what each of
    them, such as `body[1]`, was in ROSS."""

    tables: dict[str, Any]
    notes: tuple[str, ...]
    elements: dict[str, str]


def is_ross(data: Mapping[str, Any]) -> bool:
    """Return whether the content of a TOML or JSON file is a rotor that ROSS saved."""
    return "ross_version" in data or any(key.startswith(f"{_SHAFT}_") for key in data)


def parse_ross(text: str, name: str = "rotor", *, is_json: bool = False) -> Imported:
    """Read a rotor that ROSS 2.3 or 3.x saved as TOML or JSON, to be called `name`.

    Raises `QuantityError` naming the element, its value and what is allowed.
    """
    try:
        data = json.loads(text, object_pairs_hook=_once) if is_json else tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        kind = "JSON" if is_json else "TOML"
        raise QuantityError(f"not valid {kind}: {' '.join(str(error).split())}") from error
    if not isinstance(data, dict) or not is_ross(data):
        raise QuantityError("not a rotor that ROSS saved: no ross_version and no ShaftElement_...")
    return _Reader(data, name).read()


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return a table of JSON, which would keep but the last of the elements of one name."""
    table: dict[str, Any] = {}
    for key, value in pairs:
        if key in table:
            raise ValueError(f"{key!r} is there twice")
        table[key] = value
    return table


class _Reader:
    """The file, element by element."""

    def __init__(self, data: dict[str, Any], name: str) -> None:
        self._name = name
        self._is_3 = not str(data.get("ross_version", "2")).startswith(("0.", "1.", "2"))
        self._notes: list[str] = []
        self._origins = dict(_ORIGINS)
        self._elements = []
        for key, value in data.items():
            if key in _HEAD:
                continue
            self._elements.append(self._element(key, value))
        head = a_table("parameters", data.get("parameters", {}))
        self._parameters = Element("parameters", "parameters", head)

    def _element(self, key: str, value: object) -> Element:
        """Return an element; a bearing or seal that ROSS computed is one by its coefficients."""
        kind = key.partition("_")[0]
        values = a_table(key, value)
        is_computed = kind in _COMPUTED or any(name in values for name in _COMPUTED_BY)
        if kind in (_SHAFT, _DISC, _MASS, *_BEARINGS) and not is_computed:
            return Element(key, kind, values)
        if not is_computed or "kxx" not in values or "cxx" not in values:
            other = ", or save its coefficients as a BearingElement" if is_computed else ""
            raise QuantityError(f"{key}: a {kind} of ROSS is not supported; remove it{other}")
        note = f"{key}: imported by its coefficients; what ROSS computed them from is left out"
        if _CONTROLLED in values and isinstance(values.get("frequency"), list):
            note += (
                ", and the frequency of vibration, over which its control has them, is taken for "
                "the speed, which holds for synchronous vibration alone"
            )
        self._notes.append(note)
        own = {name: of for name, of in values.items() if name in _OF_BEARINGS}
        return Element(key, "SealElement" if "Seal" in kind else "BearingElement", own)

    def read(self) -> Imported:
        """Return the tables of a machine file, with what is left out. Raises `QuantityError` for
        what a machine cannot have."""
        shaft = self._of(_SHAFT)
        sections, materials = sections_of(shaft, self._origins)
        tables: dict[str, Any] = {"name": self._name, "material": materials, "section": sections}
        speeds = {ours: self._parameters.number(w, 0.0) for w, ours in _SPEEDS.items()}
        tables["operation"] = {name: speed for name, speed in speeds.items() if speed != 0}
        tables["shaft"] = self._damping(shaft)
        last = len(sections)
        pedestals = self._pedestals(last)
        for table, ground in pedestals.values():
            self._append(tables, "housing", table, ground)
        for element in self._of(_DISC):
            element.refuse_others("n", "m", "Id", "Ip")
            body = {"mass": element.number("m"), "I_d": element.number("Id")}
            body["I_p"] = element.number("Ip")
            self._append(tables, "body", self._on_shaft(element, last) | body, element)
        for element in self._of(_MASS):
            if element.node() not in pedestals:
                mass = {"mass": self._mass(element)}
                self._append(tables, "point_mass", self._on_shaft(element, last) | mass, element)
        grounded = [bearing for _, bearing in pedestals.values()]
        for element in self._of(*_BEARINGS):
            if element not in grounded:
                held = self._bearing(element, last, pedestals)
                self._append(tables, _BEARINGS[element.kind], held, element)
        given = {k: v for k, v in tables.items() if v}
        return Imported(given, tuple(map(printable, self._notes)), self._origins)

    def _damping(self, shaft: list[Element]) -> dict[str, float]:
        """Return the damping of the shaft by its stiffness [s] and mass [1/s]; that of the whole
        rotor, of ROSS 3, is in the place of the elements' own."""
        self._parameters.refuse_others(*_SPEEDS, "alpha", "beta", *_MODAL)
        self._parameters.refuse_nonzero("alpha", *_MODAL)
        whole = self._parameters.number("beta", 0.0)
        beta = whole or self._of_all(shaft, "beta", "eta_v")
        alpha = 0.0 if whole else self._of_all(shaft, "alpha", "mass_damping")
        if beta != 0 and any(element.number("axial_force", 0.0) != 0 for element in shaft):
            self._notes.append(
                "beta: damps bending and shear, where in ROSS axial_force adds to it"
            )
        return {"eta_v": beta} | ({"mass_damping": alpha} if alpha != 0 else {})

    @staticmethod
    def _of_all(shaft: list[Element], key: str, here: str) -> float:
        each = {element.number(key, 0.0) for element in shaft}
        if len(each) > 1:
            raise QuantityError(f"{key}: is not the same of all shaft elements; here one {here} is")
        return each.pop() if each else 0.0

    def _of(self, *kinds: str) -> list[Element]:
        return [element for element in self._elements if element.kind in kinds]

    def _append(
        self, tables: dict[str, Any], kind: str, table: dict[str, Any], element: Element
    ) -> None:
        parts = tables.setdefault(kind, [])
        parts.append(table)
        self._origins[f"{kind}[{len(parts)}]"] = element.where

    @staticmethod
    def _on_shaft(element: Element, last: int) -> dict[str, Any]:
        if element.node() > last:
            raise QuantityError(f"{element.where}.n = {element.node()}: the shaft ends at {last}")
        return {"node": element.node() + 1}

    def _masses(self, element: Element) -> tuple[float, float]:
        element.refuse_others("n", "m", "mx", "my", "mz")
        plain = element.values.get("m")
        return element.number("mx", plain), element.number("my", plain)

    def _mass(self, element: Element) -> float:
        x, y = self._masses(element)
        if x != y:
            raise QuantityError(
                f"{element.where}: mx = {x:g} kg and my = {y:g} kg: must be the same in x and y"
            )
        return x

    def _pedestals(self, last: int) -> dict[int, tuple[dict[str, Any], Element]]:
        """Return the housings by their nodes, with the bearings that hold them to ground."""
        result = {}
        linked = {
            e.node("n_link"): e
            for e in self._of(*_BEARINGS)
            if e.values.get("n_link") is not None and e.node("n_link") > last
        }
        for n, user in linked.items():
            holding = [e for e in self._of(*_BEARINGS) if e.node() == n]
            masses = [self._masses(e) for e in self._of(_MASS) if e.node() == n]
            mass, vertical = (sum(m[axis] for m in masses) for axis in (0, 1))
            if len(holding) != 1 or mass <= 0 or vertical <= 0:
                raise QuantityError(
                    f"{user.where}.n_link = {n}: a pedestal must be a PointMass on one "
                    f"BearingElement to ground; there is {mass:g} kg on {len(holding)} of them"
                )
            ground = holding[0]
            ground.refuse_nonzero(*_MASSES)
            coefficients = self._coefficients(ground)
            crossed = [k for k in ("kxy", "kyx", "cxy", "cyx") if coefficients.get(k, 0.0) != 0]
            tabled = [k for k, v in coefficients.items() if isinstance(v, list)]
            if crossed or tabled or ground.values.get("n_link") is not None:
                what = (crossed + tabled + ["n_link"])[0]
                raise QuantityError(
                    f"{ground.where}.{what}: a pedestal here stands on constant springs and "
                    "dampers in x and y to ground"
                )
            housing = {"name": f"pedestal {n}", "mass": mass}
            if vertical != mass:
                housing["mass_ratio"] = vertical / mass
            housing |= {f"{of}{a}": coefficients[f"{of}{a}{a}"] for of in "kc" for a in "xy"}
            result[n] = housing, ground
        return result

    def _coefficients(self, element: Element) -> dict[str, Any]:
        """Return the eight coefficients, and the speeds where they are tables."""
        element.refuse_others(*_OF_BEARINGS)
        for key in ("kxx", "cxx"):
            if not element.has(key):
                raise QuantityError(f"{element.where}.{key} is missing")
        idle = [key for key in _NOT_LATERAL if element.column(key) != 0]
        if idle:
            self._notes.append(f"{element.where}: {', '.join(idle)}: no lateral force, left out")
        # those along y are those along x, unless they are given
        alike = {f"{of}yy": f"{of}xx" for of in "kc" if not element.has(f"{of}yy")}
        own = {key: element.column(alike.get(key, key)) for key in _COEFFICIENTS}
        tables = {key: column for key, column in own.items() if isinstance(column, list)}
        if not tables:
            return own
        is_over_speed = self._is_3 or isinstance(element.column("speed"), list)
        axis = "speed" if is_over_speed else "frequency"
        if self._is_3 and isinstance(element.column("frequency"), list):
            raise QuantityError(
                f"{element.where}.frequency: a table over the whirl frequency has no meaning in "
                "time; save it over the speed alone"
            )
        way = element.values.get("interpolation", "pchip") or "pchip"
        if way != "pchip":
            raise QuantityError(f"{element.where}.interpolation = {way!r}: must be pchip")
        speeds = element.column(axis)
        if not isinstance(speeds, list):
            raise QuantityError(f"{element.where}.{axis}: must be a list, as {next(iter(tables))}")
        if not self._is_3 and len(speeds) > 2:
            self._notes.append(
                f"{element.where}: between the points of its table PCHIP, where ROSS 2 has a spline"
            )
        return own | {"speed": speeds}

    def _bearing(
        self, element: Element, last: int, pedestals: Mapping[int, tuple[dict[str, Any], Element]]
    ) -> dict[str, Any]:
        table = self._on_shaft(element, last)
        if element.values.get("n_link") is not None:
            n = element.node("n_link")
            if n not in pedestals:
                raise QuantityError(
                    f"{element.where}.n_link = {n}: a bearing between two shaft nodes is not "
                    "supported"
                )
            table["housing"] = pedestals[n][0]["name"]
        return table | self._added_mass(element) | self._coefficients(element)

    @staticmethod
    def _added_mass(element: Element) -> dict[str, float]:
        """Return the added mass [kg], which here is the same in x and y and at every speed."""
        element.refuse_nonzero("mxy", "myx")
        x, y = (element.column(k if element.has(k) else "mxx") for k in ("mxx", "myy"))
        if isinstance(x, list) or x != y:
            where = f"{element.where}.mxx = {x}, myy = {y}"
            raise QuantityError(f"{where}: must be the same, at all speeds too")
        return {"added_mass": x} if x != 0 else {}
