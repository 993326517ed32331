//! [[probe]]: points whose displacement and stress are reported.

use super::document::Item;
use super::ties::body_name;
use super::SceneReader;
use crate::model::body::BodySpec;
use crate::model::spec::ProbeSpec;
use base::Result;

impl SceneReader {
    pub(super) fn probe(&self, item: &Item, bodies: &[BodySpec]) -> Result<ProbeSpec> {
        let mut section = item.section("[[probe]]")?;
        let name = section.need("name", "a name")?.text("a name")?;
        let body = section.read("body", |item| body_name(item, bodies, "the name of a body"))?;
        let wanted = ["a point [x, y]", "a point [x, y, z]"][self.dim - 2];
        let point = self.vector(section.need("point", wanted)?, wanted)?;
        section.finish()?;
        Ok(ProbeSpec {
            name,
            body,
            point,
            location: item.location(),
        })
    }
}
