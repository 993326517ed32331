"""Fields from ParaView's unstructured grids (``.vtu``) as the program writes them.

Arrays are base64 of blocks that zlib compressed. In front of them stand, as UInt64 and in a base64 of their own: the
number of blocks, their size, the size of the last one if it is smaller (else 0), and the compressed size of each.
"""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ElementTree
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pyvista

_TYPES = {"Float64": "<f8", "Float32": "<f4", "Int64": "<i8", "Int32": "<i4", "UInt8": "u1"}


@dataclass(frozen=True)
class Fields:
    """A grid with its data, of all bodies. A node of a body is one point for each of its materials there."""

    points: np.ndarray
    """Places (n, 3), lengths; z = 0 in the plane."""
    connectivity: np.ndarray
    """Points of the cells, one cell after the other."""
    offsets: np.ndarray
    """Where each cell ends in `connectivity`, (m,)."""
    types: np.ndarray
    """VTK's numbers of the kinds of cells, (m,)."""
    point_data: dict[str, np.ndarray]
    """(n,) or (n, components): ``u``, in elasticity ``stress`` and ``strain`` (xx, yy, zz, xy, yz, xz), ..."""
    cell_data: dict[str, np.ndarray]
    """(m,) or (m, components): ``body``, ``subdomain``, ``rank``, ``young`` or ``rho``, ..."""

    def cells(self) -> dict[int, np.ndarray]:
        """The cells by kind: VTK's number, and the points of the cells (cells of this kind, nodes)."""
        ends, starts = self.offsets, np.concatenate([[0], self.offsets[:-1]])
        out = {}
        for kind in np.unique(self.types):
            at = np.flatnonzero(self.types == kind)
            nodes = ends[at[0]] - starts[at[0]]
            out[int(kind)] = self.connectivity[starts[at][:, None] + np.arange(nodes)]
        return out

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """The grid for pyvista, with all data.

        Raises
        ------
        ImportError
            pyvista is not installed.
        """
        import pyvista

        starts = np.concatenate([[0], self.offsets[:-1]])
        cells = np.insert(self.connectivity, starts, np.diff(self.offsets, prepend=0))
        grid = pyvista.UnstructuredGrid(cells, self.types, self.points)
        for name, values in self.point_data.items():
            grid.point_data[name] = values
        for name, values in self.cell_data.items():
            grid.cell_data[name] = values
        return grid


def read_vtu(path: str | Path) -> Fields:
    """Reads a file that ``fetifeti solve`` wrote.

    Raises
    ------
    ValueError
        The file is of another kind: no compressed base64 in one piece.
    """
    root = ElementTree.parse(path).getroot()
    wanted = {"type": "UnstructuredGrid", "byte_order": "LittleEndian", "header_type": "UInt64"}
    wanted["compressor"] = "vtkZLibDataCompressor"
    for key, value in wanted.items():
        if root.get(key) != value:
            raise ValueError(f"{path} has {key} '{root.get(key)}', expected '{value}'")
    pieces = root.findall("UnstructuredGrid/Piece")
    if len(pieces) != 1:
        raise ValueError(f"{path} has {len(pieces)} pieces, expected one")

    def arrays(tag: str) -> dict[str, np.ndarray]:
        return {str(a.get("Name")): _array(path, a) for a in pieces[0].findall(f"{tag}/DataArray")}

    cells, points = arrays("Cells"), arrays("Points")["Points"]
    return Fields(
        points, cells["connectivity"], cells["offsets"], cells["types"], arrays("PointData"), arrays("CellData")
    )


def _array(path: Any, element: ElementTree.Element) -> np.ndarray:
    """The numbers of an array, with a column for each component where it has several."""
    kind, text = element.get("type"), "".join((element.text or "").split())
    if kind not in _TYPES or element.get("format") != "binary":
        raise ValueError(f"{path}: array '{element.get('Name')}' is {kind} as {element.get('format')}")
    count = int(np.frombuffer(base64.b64decode(text[:12])[:8], "<u8")[0])
    length = 4 * -(-8 * (3 + count) // 3)  # characters of the header
    sizes = np.frombuffer(base64.b64decode(text[:length]), "<u8")[3:].astype(int)
    data, start, blocks = base64.b64decode(text[length:]), 0, []
    for size in sizes:
        blocks.append(zlib.decompress(data[start : start + size]))
        start += size
    values = np.frombuffer(b"".join(blocks), _TYPES[kind])
    components = int(element.get("NumberOfComponents", 1))
    return values.reshape(-1, components) if components > 1 else values
