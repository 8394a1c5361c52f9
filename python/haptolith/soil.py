"""Soils with names, and soils found for what was measured."""

from __future__ import annotations

import ctypes
import os
import re
from typing import Optional, Union

from . import _abi
from ._long import Progress, call_long
from ._owned import Owned
from .errors import InvalidParameter, require
from .result import Result, names, take
from .values import text_from, toml_value

_lib = _abi.lib
_SHOWN = (("friction_angle_deg", "deg"), ("cohesion_pa", "Pa"), ("bulk_density_kg_m3", "kg/m3"))


def soils() -> list[str]:
    """Names of the built-in soils."""
    return names("soils")


def presets() -> list[str]:
    """The soils of the ICRA 2021 paper, P1 to P6."""
    return names("presets")


class Soil(Owned):
    """A soil: a built-in name (haptolith.soils()), a preset of the ICRA 2021 paper, or a soil file.

    soil["target.friction_angle_deg"], soil["soil.radius_mm"], soil["reached.cohesion_pa"]: numbers of its file.
    """

    _destroy = _lib.hapto_soil_destroy
    _preset: Optional[str] = None

    def __init__(self, name_or_path: Union[str, os.PathLike[str]]) -> None:
        name = os.fspath(name_or_path)
        out = ctypes.c_void_p()
        require(_lib.hapto_soil_find(name.encode(), ctypes.byref(out)))
        self._handle = out.value
        if name in presets():
            self._preset = name

    @classmethod
    def _of(cls, address: Optional[int]) -> Soil:
        soil = cls.__new__(cls)
        soil._handle = address
        return soil

    @classmethod
    def from_toml(cls, text: str) -> Soil:
        """A soil from the text of a soil file."""
        out = ctypes.c_void_p()
        require(_lib.hapto_soil_from_toml(text.encode(), None, ctypes.byref(out)))
        return cls._of(out.value)

    def __getitem__(self, key: str) -> float:
        number = ctypes.c_double()
        require(_lib.hapto_soil_get(self.address, key.encode(), ctypes.byref(number)))
        return number.value

    @property
    def toml(self) -> str:
        """The soil as a soil file. Raises InvalidParameter for a preset, of which nothing was measured."""
        return text_from(lambda out, room, needed: int(_lib.hapto_soil_get_toml(self.address, out, room, needed)))[:-1].decode()

    def profile(self, gravity_m_s2: float = 1.625, depth_m: float = 0.6) -> Result:
        """Its layers under their own weight: columns depth_m, top_m, bottom_m, spacing_m, density_kg_m3."""
        out = ctypes.c_void_p()
        require(_lib.hapto_soil_profile(self.address, gravity_m_s2, depth_m, ctypes.byref(out)))
        return take(out)

    def __repr__(self) -> str:
        if not self._handle:
            return "<haptolith.Soil, closed>"
        if self._preset:
            return f"<haptolith.Soil: preset {self._preset} of icra2021>"
        toml = self.toml
        named = re.search(r'^name = "([^"]*)"', toml, re.M)
        known = ((key, unit) for key, unit in _SHOWN if re.search(rf"^{key} = ", toml, re.M))
        return f"<haptolith.Soil: {named[1] if named else 'own soil'}{''.join(self._shown(key, unit) for key, unit in known)}>"

    def _shown(self, key: str, unit: str) -> str:
        try:
            return f", {key.split('_')[0]} {self[f'target.{key}']:g} {unit}"
        except InvalidParameter:
            return ""

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return (Soil, (self._preset,)) if self._preset else (Soil.from_toml, (self.toml,))


def calibrate(friction_angle_deg: float, cohesion_pa: float, bulk_density_kg_m3: float, *,
              progress: Optional[Progress] = None, **options: object) -> tuple[Soil, Result]:
    """Finds macroparticles whose sheared bed is as an engineer measured; takes minutes.

    options: strength ("residual" or "peak"), density ("lunar": more of it deeper, or "constant"), radius_mm, stiffness_n_m, body,
    seed, threads, specimens, name, source.
    Returns the soil, and what the laboratory measured of it: mean and standard deviation over specimens."""
    asked: dict[str, object] = {"friction_angle_deg": friction_angle_deg, "cohesion_pa": cohesion_pa,
                                "bulk_density_kg_m3": bulk_density_kg_m3, **options}
    text = "".join(f"{key} = {toml_value(value)}\n" for key, value in asked.items()).encode()
    soil, report = ctypes.c_void_p(), ctypes.c_void_p()
    call_long(lambda told: int(_lib.hapto_soil_calibrate(text, told, None, ctypes.byref(soil), ctypes.byref(report))), progress)
    return Soil._of(soil.value), take(report)
