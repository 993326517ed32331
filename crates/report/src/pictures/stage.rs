//! A solid from one viewpoint: its surface in the colours of a field, lit, with lines around bodies and between
//! subdomains.

use super::mesh::{bounds, SolidMesh};
use super::obstacles::GREY;
use super::rigid_faces::{triangles, Beside};
use super::space::{Buffer, Camera};
use super::surface::{diagonals, unit_cross, VisibleSurface};
use super::values::ShownField;
use crate::drawing::canvas::Colour;
use crate::drawing::raster::Raster;
use base::linalg::vec3::{dot, minus};

/// Largest size of one picture.
const PANEL: (f64, f64) = (470.0, 440.0);
/// Colour of faces in contact.
pub(super) const CLOSED: Colour = Colour(0xe8, 0x10, 0x3c);
/// How much an obstacle in front of a body covers it.
const VEIL: f64 = 0.3;
/// The part of white in the colour of faces that may touch and do not.
const PALE: f64 = 0.45;

/// A solid from one viewpoint, its bodies shifted.
pub(super) struct Stage<'a> {
    solid: &'a SolidMesh<'a>,
    surface: &'a VisibleSurface,
    pub camera: Camera,
    shifts: &'a [[f64; 3]],
    /// The surfaces of obstacles.
    beside: Vec<[[f64; 3]; 3]>,
    low: [f64; 2],
    high: [f64; 2],
    /// Logical pixels per unit of length.
    scale: f64,
}

impl<'a> Stage<'a> {
    pub fn new(
        solid: &'a SolidMesh<'a>,
        surface: &'a VisibleSurface,
        camera: Camera,
        shifts: &'a [[f64; 3]],
    ) -> Stage<'a> {
        let mut stage = Stage {
            solid,
            surface,
            camera,
            shifts,
            beside: Vec::new(),
            low: [0.0; 2],
            high: [1.0; 2],
            scale: 1.0,
        };
        stage.fit();
        stage
    }

    /// This stage with the obstacles and rigid surfaces in `beside`.
    pub fn beside(mut self, beside: &Beside) -> Self {
        let bodies = bounds(self.solid.shown.iter().copied());
        let all = beside.obstacles.iter().flat_map(|o| o.triangles(bodies));
        self.beside = all.collect();
        self.beside.extend(triangles(beside.faces, bodies));
        self.fit();
        self
    }

    /// Finds the part of the picture plane that is shown.
    fn fit(&mut self) {
        let (surface, solid) = (self.surface, self.solid);
        let corners = surface.faces.iter().flat_map(|f| f.corners.map(|p| (f, p)));
        let places = corners.map(|(f, p)| self.projected(p, solid.body[f.cell as usize]));
        let beside = self.beside.as_flattened().iter();
        let places = places.chain(beside.map(|&p| self.camera.project(p)));
        let [low, high] = bounds(places.map(|[x, y, _]| [x, y]));
        let size = [0, 1].map(|d| (high[d] - low[d]).max(1e-300));
        self.scale = (PANEL.0 / size[0]).min(PANEL.1 / size[1]);
        [self.low, self.high] = [low, high];
    }

    fn projected(&self, p: u32, body: u32) -> [f64; 3] {
        let (at, shift) = (self.solid.shown[p as usize], self.shifts[body as usize]);
        self.camera.project([0, 1, 2].map(|d| at[d] + shift[d]))
    }

    /// Size in logical pixels, with a margin for lines.
    pub fn size(&self) -> (f64, f64) {
        let [w, h] = [0, 1].map(|d| self.scale * (self.high[d] - self.low[d]) + 6.0);
        (w, h)
    }

    pub fn paint(
        &self,
        raster: &mut Raster,
        field: &ShownField,
        range: (f64, f64),
        at: (f64, f64),
    ) {
        let (w, h) = self.size();
        let (mut buffer, fine) = Buffer::new(w, h, raster);
        let unit = fine * self.scale;
        let on_paper = |[x, y, near]: [f64; 3]| {
            [
                fine * 3.0 + unit * (x - self.low[0]),
                fine * 3.0 + unit * (self.high[1] - y),
                unit * near,
            ]
        };
        let place = |p: u32, body: u32| on_paper(self.projected(p, body));
        let colour = field.colour(range);
        for face in &self.surface.faces {
            let body = self.solid.body[face.cell as usize];
            let positions = face.corners.map(|p| self.solid.shown[p as usize]);
            let ([u, v], _) = diagonals(positions);
            let normal = unit_cross(u, v);
            if dot(normal, self.camera.towards) <= 0.0 {
                continue;
            }
            let light = light(normal, &self.camera);
            let values = field.at(face.cell as usize, face.corners);
            let corners = face.corners.map(|p| place(p, body));
            let (_, centre) = diagonals(corners);
            let mean = values.iter().sum::<f64>() / 4.0;
            let shade = |v: f64| match face.mark {
                Some(true) => dimmed(CLOSED, light),
                Some(false) => dimmed(pale(colour(v)), light),
                None => dimmed(colour(v), light),
            };
            for k in 0..4 {
                let l = (k + 1) % 4;
                let triangle = [corners[k], corners[l], centre];
                buffer.triangle(triangle, [values[k], values[l], mean], &shade);
            }
        }
        // Where bodies or subdomains are only a few pixels wide their lines would hide the field.
        let spacing = |numbers: &[u32]| {
            let n = numbers.iter().max().map_or(1, |&m| m + 1);
            (w * h * (w * h).sqrt() / f64::from(n)).cbrt()
        };
        let subdomains = spacing(self.solid.subdomain);
        let bodies = (0.012 * spacing(self.solid.body)).clamp(0.5, 1.3);
        for edge in &self.surface.edges {
            let ends = edge.ends.map(|p| place(p, edge.body));
            if edge.crease {
                buffer.line(ends, fine * bodies, 2.0 * fine, Colour(0, 0, 0));
            } else if subdomains > 12.0 {
                buffer.line(ends, fine * 0.55, 1.5 * fine, Colour::WHITE);
            }
        }
        let mut veil = buffer.empty();
        for triangle in &self.beside {
            let [a, b, c] = *triangle;
            let normal = unit_cross(minus(b, a), minus(c, a));
            let towards = dot(normal, self.camera.towards).signum();
            let light = light(normal.map(|x| towards * x), &self.camera);
            let corners = triangle.map(|p| on_paper(self.camera.project(p)));
            veil.triangle(corners, [0.0; 3], &|_| dimmed(GREY, light));
        }
        buffer.lay(&veil, VEIL);
        buffer.copy(raster, at);
    }
}

fn dimmed(Colour(r, g, b): Colour, light: f64) -> Colour {
    let dim = |c: u8| (f64::from(c) * light).round() as u8;
    Colour(dim(r), dim(g), dim(b))
}

/// The colour of a face that may touch and does not.
pub(super) fn pale(Colour(r, g, b): Colour) -> Colour {
    let mix = |c: u8| (f64::from(c) * (1.0 - PALE) + 255.0 * PALE).round() as u8;
    Colour(mix(r), mix(g), mix(b))
}

/// The brightness of a face. The light comes from above the viewer's left shoulder and leaves no side dark, because
/// colours must remain readable.
fn light(normal: [f64; 3], camera: &Camera) -> f64 {
    let seen = camera.project(normal);
    let from = [-0.35, 0.65, 0.67];
    0.82 + 0.18 * dot(seen, from).clamp(0.0, 1.0)
}
