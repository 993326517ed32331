//! A reader of Gmsh's mesh files: formats 2.0 to 2.2, 4.0 and 4.1, as text and binary, of either order of bytes.
//!
//! It is our own because the crate `mshio` (0.4) reads 4.1 only and drops the names of physical groups, and PETSc's
//! DMPlex keeps no numbers of nodes and elements and refuses second order where a mesh mixes kinds of cells.
//!
//! It is strict: a file is read as a whole or refused with one sentence. Of all sections it reads $PhysicalNames,
//! $Entities, $PartitionedEntities, $Nodes (or $ParametricNodes) and $Elements; it passes over the others. Physical
//! groups become groups of cells: an element is in all groups of its entity, a group without a name has its number as
//! its name, a group that has a name and no elements is empty. The sign of a physical group, which is an orientation,
//! is dropped. What is said of a mesh beyond its file, such as inverted cells, is for others to check.

mod elements;
mod kinds;
mod names;
mod nodes;
mod scan;
mod version2;
mod version4;
mod write;

use super::file::{bytes, MeshFile};
use base::Result;
use elements::GmshElements;
use names::{GroupNames, PhysicalGroups};
use nodes::Nodes;
use scan::{quoted, Encoding, Scan, Width};
use std::path::Path;
use version4::{Entities, FormatWidths};
pub use write::write;

/// Reads the file `path`.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) with file, line or byte, what was found and what was expected.
pub fn load(path: impl AsRef<Path>) -> Result<MeshFile> {
    let path = path.as_ref();
    read(&path.display().to_string(), &bytes(path, "mesh")?)
}

/// Reads the bytes of a file; `name` names it in messages.
///
/// # Errors
/// As [`load`].
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshFile> {
    let mut scan = Scan::new(name, bytes);
    let format = header(&mut scan)?;
    let mut parts = GmshSections::default();
    let mut seen: Vec<&str> = Vec::new();
    while let Some((at, section)) = scan.section()? {
        if seen.contains(&section) || section == "MeshFormat" {
            return Err(scan.fail(at, format!("${section} is here a second time")));
        }
        if parts.section(&mut scan, format, at, section)? {
            seen.push(section);
        } else {
            scan.skip(at, section)?;
        }
    }
    parts.finish(&scan, name)
}

/// The sections that were read so far.
#[derive(Default)]
struct GmshSections {
    names: GroupNames,
    entities: Entities,
    nodes: Option<Nodes>,
    elements: Option<(GmshElements, PhysicalGroups)>,
}

impl GmshSections {
    /// Reads a section that begins at `at`, unless it is one that is passed over.
    fn section(
        &mut self,
        scan: &mut Scan,
        format: GmshFormat,
        at: usize,
        section: &str,
    ) -> Result<bool> {
        match (section, format) {
            ("PhysicalNames", GmshFormat::Two { named_by_number }) => {
                self.names = GroupNames::read(scan, !named_by_number)?;
            }
            ("PhysicalNames", GmshFormat::Four(_)) => self.names = GroupNames::read(scan, true)?,
            ("Entities" | "PartitionedEntities", GmshFormat::Four(layout)) => {
                if self.elements.is_some() {
                    let message = format!("${section} was expected before $Elements");
                    return Err(scan.fail(at, message));
                }
                self.entities.read(scan, layout, section)?;
            }
            ("Nodes", GmshFormat::Four(layout)) => {
                self.nodes = Some(version4::nodes(scan, layout)?)
            }
            ("Nodes" | "ParametricNodes", GmshFormat::Two { .. }) => {
                if self.nodes.is_some() {
                    return Err(scan.fail(at, format!("${section} is here after other nodes")));
                }
                self.nodes = Some(version2::nodes(scan, section == "ParametricNodes")?);
            }
            ("Elements", _) => {
                let Some(nodes) = &self.nodes else {
                    return Err(scan.fail(at, "$Elements was expected after $Nodes"));
                };
                self.elements = Some(match format {
                    GmshFormat::Two { .. } => version2::elements(scan, nodes)?,
                    GmshFormat::Four(layout) => {
                        version4::elements(scan, layout, nodes, &self.entities)?
                    }
                });
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn finish(self, scan: &Scan, name: &str) -> Result<MeshFile> {
        let missing = |section| {
            let message = format!("the section ${section} was expected and is missing");
            scan.fail_whole(message)
        };
        let nodes = self.nodes.ok_or_else(|| missing("Nodes"))?;
        let (elements, groups) = self.elements.ok_or_else(|| missing("Elements"))?;
        Ok(MeshFile {
            name: name.to_string(),
            points: nodes.points,
            node_ids: nodes.ids,
            resolution: scan.digits.resolution(),
            cells: elements.cells,
            cell_ids: elements.ids,
            groups: groups.name(scan, &self.names)?,
        })
    }
}

/// How the file is written.
#[derive(Debug, Clone, Copy)]
enum GmshFormat {
    /// 2.0, 2.1 or 2.2.
    Two {
        /// Format 2.0 may name physical groups without their dimension.
        named_by_number: bool,
    },
    /// 4.0 or 4.1.
    Four(FormatWidths),
}

/// Reads up to the end of $MeshFormat, which only comments may precede.
fn header(scan: &mut Scan) -> Result<GmshFormat> {
    loop {
        match scan.section()? {
            Some((at, "Comments")) => scan.skip(at, "Comments")?,
            Some((_, "MeshFormat")) => break,
            Some((at, "NOD")) => {
                let message =
                    "format 1 is not read, 2.0 to 2.2, 4.0 or 4.1 was expected; Gmsh converts it";
                return Err(scan.fail(at, message));
            }
            Some((at, other)) => {
                return Err(scan.fail(at, format!("found ${other} where $MeshFormat was expected")));
            }
            None => return Err(scan.fail_whole("the file is empty, $MeshFormat was expected")),
        }
    }
    let (at, line) = scan.line();
    let words: Vec<&[u8]> = line
        .split(u8::is_ascii_whitespace)
        .filter(|w| !w.is_empty())
        .collect();
    let [version, kind, size] = words[..] else {
        let found = quoted(line);
        let message = format!(
            "found {found} where version, kind and size were expected, such as \"4.1 0 8\""
        );
        return Err(scan.fail(at, message));
    };
    let binary = match kind {
        b"0" => false,
        b"1" => true,
        _ => {
            let found = quoted(kind);
            return Err(scan.fail(
                at,
                format!("found {found} where 0 (text) or 1 (binary) was expected"),
            ));
        }
    };
    let size = match size {
        b"4" => Width::Four,
        b"8" => Width::Eight,
        _ => {
            return Err(scan.fail(
                at,
                format!(
                    "found {} where a size of 4 or 8 bytes was expected",
                    quoted(size)
                ),
            ))
        }
    };
    let four = |old, counts, ids| GmshFormat::Four(FormatWidths { old, counts, ids });
    let format = match version {
        b"2" | b"2.0" => GmshFormat::Two {
            named_by_number: true,
        },
        b"2.1" | b"2.2" => GmshFormat::Two {
            named_by_number: false,
        },
        b"4" | b"4.0" => four(true, Width::Eight, Width::Four),
        b"4.1" => four(false, size, size),
        _ => {
            let found = quoted(version);
            let known = "2.0, 2.1, 2.2, 4.0 or 4.1";
            let message =
                format!("found the format {found} where {known} was expected; Gmsh converts it");
            return Err(scan.fail(at, message));
        }
    };
    if binary {
        if version != b"4.1" && size == Width::Four {
            return Err(scan.fail(
                at,
                "found numbers of 4 bytes where 8 were expected in this format",
            ));
        }
        endianness(scan)?;
    }
    scan.end("MeshFormat")?;
    Ok(format)
}

/// The number 1 tells the order of bytes.
fn endianness(scan: &mut Scan) -> Result<()> {
    scan.encode(Encoding::Little);
    let at = scan.at();
    let one = scan.whole(Width::Four, "the number 1, which tells the order of bytes,")?;
    match one {
        1 => Ok(()),
        0x0100_0000 => {
            scan.encode(Encoding::Big);
            Ok(())
        }
        _ => Err(scan.fail(
            at,
            format!("found {one} where the number 1 was expected, which tells the order of bytes"),
        )),
    }
}

#[cfg(test)]
#[path = "../../tests/gmsh/mod.rs"]
mod tests;
