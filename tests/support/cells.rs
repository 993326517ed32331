//! Scenes with coefficients in files beside them.

use super::mpi::Scratch;
use base::Error;
use mesh::places;
use png::{BitDepth, ColorType};
use scene::Scene;

/// The coefficients of all elements of a scene of one grid, x running fastest over the whole grid.
pub fn elements(scene: &Scene, bodies: [usize; 3], pick: impl Fn(usize) -> Vec<f64>) -> Vec<f64> {
    let mesh = scene.bodies[0].mesh().grid().unwrap();
    let each = mesh.elements.map(|n| n.max(1));
    let all = [0, 1, 2].map(|d| bodies[d] * each[d]);
    let mut out = vec![f64::NAN; all.iter().product()];
    for s in 0..scene.n_subdomains() {
        let (b, inside) = scene.body_of(s);
        let (place, block) = (scene.bodies[b].spec.place, mesh.block(inside));
        let values = pick(s);
        let own = places(block.elements.map(|n| n.max(1)));
        for (at, value) in own.zip(values) {
            let [i, j, k] = [0, 1, 2].map(|d| place[d] * each[d] + block.first[d] + at[d]);
            out[(k * all[1] + j) * all[0] + i] = value;
        }
    }
    out
}

pub fn rho(scene: &Scene, bodies: [usize; 3]) -> Vec<f64> {
    elements(scene, bodies, |s| scene.subdomain_mesh(s).unwrap().rho)
}

pub fn counting(n: usize) -> Vec<f64> {
    (1..=n).map(|v| v as f64).collect()
}

pub fn bytes32(values: &[f64]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|v| (*v as f32).to_le_bytes())
        .collect()
}

pub fn bytes64(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Writes a picture, `data` as the depth packs it.
pub fn paint(path: &str, size: [u32; 2], colour: ColorType, depth: BitDepth, data: &[u8]) {
    let file = std::fs::File::create(path).unwrap();
    let mut encoder = png::Encoder::new(file, size[0], size[1]);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if colour == ColorType::Indexed {
        encoder.set_palette(vec![0, 0, 0, 255, 255, 255, 51, 51, 51, 9, 0, 0]);
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
}

/// A grid of 2 × 1 bodies of 4 × 4 elements in 2 × 2 subdomains beside its data.
pub struct Grid(pub Scratch);

impl Grid {
    pub fn text(rho: &str) -> String {
        format!(
            "[grid]\nbodies = [2, 1]\nelements = 4\nsubdomains = 2\ndirichlet = [\"left\"]\nrho = {rho}\n"
        )
    }

    pub fn scene(&self, rho: &str) -> Result<Scene, Error> {
        let path = self.0.file("s.toml", &Grid::text(rho));
        let scene = Scene::load(path)?;
        scene.check_values()?;
        Ok(scene)
    }

    pub fn values(&self, form: &str) -> Vec<f64> {
        let scene = self.scene(form).unwrap_or_else(|e| panic!("{form}: {e}"));
        rho(&scene, [2, 1, 1])
    }

    /// The message without the directory, and without the line that starts it.
    pub fn message(&self, rho: &str) -> String {
        let message = match self.scene(rho) {
            Ok(_) => panic!("accepted: {rho}"),
            Err(error) if error.is_input() => error.to_string(),
            Err(other) => panic!("{other:?}"),
        };
        assert!(!message.contains('\n'), "{message}");
        let directory = format!("{}/", self.0 .0.display());
        let message = message.replace(&directory, "");
        for start in ["s.toml:6: ", "s.toml:1: body `b0_0`: "] {
            if let Some(rest) = message.strip_prefix(start) {
                return rest.into();
            }
        }
        message
    }

    #[track_caller]
    pub fn refuses(&self, rho: &str, expected: &str) {
        assert_eq!(self.message(rho), expected);
    }

    pub fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.0.path(name), bytes).unwrap();
    }
}
