//! A checked scene, with every default filled in.

use super::body::{bounds_of, Body};
use super::deck::DeckScenes;
use super::geometry::interface::mostly_tied;
use super::geometry::matching::NodeMatching;
use super::geometry::{loose, overlap};
use super::idle::body::BodySlack;
use super::interfaces::Interfaces;
use super::model::expr::Expr;
use super::model::grid::GridSpec;
use super::model::joints::PairSelector;
use super::model::spec::{lee, ByDefault, Faces, ProbeSpec, SceneSpec};
use super::model::steps::Steps;
use super::part::RankPart;
use super::renewal::{may_renew, Renewal};
use super::rows::all::{Joined, SceneRows};
use super::rows::laws::NodeLaw;
use super::rows::obstacles::{Obstacle, Standing};
use super::rows::points::InterfacePoint;
use super::rows::row::Row;
use super::{axis, cut, read, rows, validate};
use crate::part;
use base::Result;
use elements::form::Form;
use fetifeti::problem::RowSource;
use mesh::text;
use std::path::Path;
use std::sync::Arc;

/// A checked scene.
///
/// ```
/// use fetifeti_scene::Scene;
///
/// let text = r#"
///     [grid]
///     bodies = [2, 1]
///     origin = [0, 0]
///     size = [2, 1]
///     subdomains = 2
///     elements_per_subdomain = 4
///     dirichlet = ["left"]
///     load = -1
///     [[contact]]
///     bodies = "all"
///     gap = 0
/// "#;
/// let scene = Scene::parse("two.toml", text)?;
/// assert_eq!((scene.n_bodies(), scene.n_subdomains()), (2, 8));
/// assert!(scene.has_contact());
/// // The bodies meet in 9 nodes, each with a row u_a − u_b ≤ 0.
/// assert_eq!(scene.substructures(&|_| true)?.rows.len(), 9);
/// // A mistake is answered with file, line and what was expected.
/// let error = Scene::parse("two.toml", &text.replace("gap", "gpa")).unwrap_err();
/// assert!(error.to_string().starts_with("two.toml:12: unknown key `gpa`"));
/// # Ok::<(), base::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Title for reports.
    pub title: String,
    /// The equation and its finite elements.
    pub form: Form,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// Pairs of bodies that touch, by increasing numbers, and the nodes at which they meet.
    pub interfaces: Interfaces,
    /// Points at which nodes of several bodies coincide or meet an obstacle, by increasing [`InterfacePoint::block`].
    pub points: Vec<InterfacePoint>,
    /// Ties, contacts and bounds at the points, in their order, pairs before obstacles; then equations between
    /// displacements; then rows between sides whose nodes do not match. [`Scene::solver_rows`] makes rows of B
    /// of them.
    pub rows: Vec<Row>,
    /// The laws of nodes that have friction or are soft, in the order of their normal rows.
    pub laws: Vec<NodeLaw>,
    /// Points of interest.
    pub probes: Vec<ProbeSpec>,
    /// Rigid obstacles, by body, side and bound.
    pub obstacles: Vec<Obstacle>,
    /// Load steps; `None`: everything is applied at once.
    pub steps: Option<Steps>,
    /// The exact solution by components, if it is known.
    pub exact: Option<Vec<Expr>>,
    /// PETSc options (without the dash) that hold unless the command line says otherwise.
    pub options: Vec<(String, String)>,
    /// Sentences on parts of the input that are left out, ignored or replaced.
    pub notes: Vec<String>,
    /// Warnings, a sentence for each circumstance that makes the answer doubtful.
    pub warnings: Vec<String>,
    /// Further remarks for users: boundary groups that no entry names, faces of joints without a partner, gaps that
    /// count as none.
    pub asides: Vec<String>,
    /// Whether load steps could renew its contacts.
    pub(crate) renewable: bool,
    /// The data from which load steps renew contacts; `None` if they do not.
    pub(super) renewal: Option<Arc<Renewal>>,
    /// Whether more nodes of interfaces are tied than in contact.
    pub(super) mostly_tied: bool,
    /// Whether it has all points, and all nodes of interfaces.
    pub(super) is_whole: bool,
    /// Whether another rank has inequalities; set where this one has read its part alone.
    pub(super) contact_elsewhere: bool,
    /// Number of subdomains.
    n_subdomains: usize,
    /// Motions without energy that are not rigid, of the bodies that have some.
    pub(super) idle: Vec<BodySlack>,
}

impl Scene {
    /// Reads and checks the scene in the file `path`; of a deck (`.inp`) the last step.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) with file, line and what was expected.
    pub fn load(path: impl AsRef<Path>) -> Result<Scene> {
        Scene::load_if(path.as_ref(), false, |_| Ok(RankPart::WHOLE))
    }

    /// [`Scene::load`] of the part that `fits` wants of what was read, unless it objects. It is asked before anything
    /// is made from that. A deck is read as a whole; its elements may be integrated in full.
    pub(super) fn load_if(
        path: &Path,
        in_full: bool,
        fits: impl FnOnce(&SceneSpec) -> Result<RankPart>,
    ) -> Result<Scene> {
        let file = path.display().to_string();
        if DeckScenes::is_deck(path) {
            let deck = DeckScenes::load(path)?.integrated(in_full);
            return deck.scene(&read::stem(&file), deck.n_steps() - 1);
        }
        let text = text(path, "scene")?;
        let spec = read::read(&file, &text)?;
        let part = fits(&spec)?;
        Scene::part(spec, part)
    }

    /// Checks the scene in `text`; `file` names it in messages.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn parse(file: &str, text: &str) -> Result<Scene> {
        Scene::new(read::read(file, text)?)
    }

    /// Checks a scene that a program has built.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for overlapping bodies, non-matching nodes on tied faces, values
    /// out of range, ….
    pub fn new(spec: SceneSpec) -> Result<Scene> {
        Scene::part(spec, RankPart::WHOLE)
    }

    /// [`Scene::new`] with the rows of a part, and with the nodes of interfaces that it needs.
    fn part(mut spec: SceneSpec, part: RankPart) -> Result<Scene> {
        validate::check(&spec)?;
        let mut steps = Steps::new(&spec)?;
        let mut bodies = Vec::with_capacity(spec.bodies.len());
        let (mut first_dof, mut first_subdomain) = (0, 0);
        let mut cuts = cut::Cuts::default();
        let mut slack = Vec::new();
        cuts.ahead(&spec.bodies, &spec.form, part.ranks == 1);
        for mut body in std::mem::take(&mut spec.bodies) {
            let components = spec.form.components(body.mesh.dim());
            cut::prepare(&mut body, &spec.form, &mut cuts)?;
            axis::constrain_axis(&mut body, &spec.form)?;
            let loose = cut::slack(&mut body, &spec.form);
            if !loose.is_empty() {
                slack.push((bodies.len(), loose));
            }
            let (nodes, subdomains) = (body.mesh.n_nodes(), body.mesh.n_subdomains());
            bodies.push(Body {
                components,
                prescribed: validate::dirichlet_dofs(&body, components)?,
                bounds: bounds_of(&body),
                spec: body,
                first_dof,
                first_subdomain,
            });
            first_dof += (nodes * components) as u64;
            first_subdomain += subdomains;
        }
        let mut matching = NodeMatching::new(&bodies);
        let written = match &steps {
            Some(steps) if steps.update => Some(spec.clone()),
            _ => None,
        };
        let origins = rows::surfaces::expand(&bodies, &mut matching, &mut spec)?;
        if let Some(steps) = &mut steps {
            steps.renumber(&spec);
        }
        let (mut interfaces, left_out) =
            rows::entries::find_interfaces(&bodies, matching, (&spec, &origins), &steps)?;
        spec.notes.extend(left_out.notes);
        spec.asides.extend(left_out.asides);
        let mut obstacles =
            rows::obstacles::find_obstacles(&bodies, &spec.obstacles, &spec.form, Standing::START)?;
        let part = match written {
            Some(_) => RankPart::WHOLE,
            // Which motions rows see follows from all rows.
            None if !slack.is_empty() => RankPart::WHOLE,
            None => part.of(&spec, &interfaces, &obstacles),
        };
        let owns = part.owns(&bodies);
        let joined = Joined {
            spec: &spec,
            interfaces: &mut interfaces,
            obstacles: &obstacles,
            known: Vec::new(),
            owns: &owns,
        };
        let SceneRows {
            points,
            rows,
            notes,
        } = joined.rows(&mut bodies, &steps, None)?;
        let t = |source: RowSource, node: usize| match source {
            RowSource::Interface(k) => interfaces[k].shared[node].t[0],
            RowSource::Obstacle(k) => obstacles[k].t(node)[0],
            RowSource::Equation(_) => 0.0,
        };
        let motion = |source: RowSource| match source {
            RowSource::Obstacle(k) => obstacles[k].motion,
            RowSource::Interface(_) | RowSource::Equation(_) => [0.0; 3],
        };
        let laws = rows::laws::collect(&bodies, &spec, &rows, &t, &motion)?;
        obstacles.iter_mut().for_each(Obstacle::finish);
        let renewal = written
            .map(|written| Renewal::new(written, &spec, &bodies, &interfaces, &obstacles, &rows));
        let renewal = renewal.transpose()?.map(Arc::new);
        spec.notes.extend(notes);
        let all = spec.ties.iter().map(|t| &t.pair);
        let mut all = all.chain(spec.contacts.iter().map(|c| &c.pair));
        // Who writes "free" and names pairs wants no others.
        if spec.default != ByDefault::Free || all.any(|pair| *pair == PairSelector::All) {
            let language = loose::Language::Scene;
            let loose = loose::sentences(&bodies, &interfaces, &rows, &spec.form, language);
            spec.notes.extend(loose);
        }
        let deep = overlap::sentences(&bodies, &interfaces, &obstacles, &spec.form);
        spec.notes.extend(deep);
        validate::check_unknowns(&bodies)?;
        let tied = mostly_tied(&interfaces);
        let interfaces = match part {
            RankPart::WHOLE => interfaces.into(),
            part => part::needed(interfaces, &bodies, &rows, part),
        };
        let mut scene = Scene {
            options: spec.options,
            title: spec.title,
            form: spec.form,
            bodies,
            interfaces,
            points,
            rows,
            laws,
            probes: spec.probes,
            obstacles,
            steps,
            exact: spec.exact,
            notes: spec.notes,
            warnings: cuts.warnings,
            asides: spec.asides,
            renewable: may_renew(&spec.form, &spec.contacts),
            renewal,
            mostly_tied: tied,
            is_whole: part == RankPart::WHOLE,
            contact_elsewhere: false,
            n_subdomains: first_subdomain,
            idle: Vec::new(),
        };
        let (idle, notes) = scene.find_idle(slack);
        scene.idle = idle;
        scene.notes.extend(notes);
        Ok(scene)
    }

    /// The experiment of Table 1 of \[Lee\]; see [`lee`].
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) when a count is zero, or when no node lies in the middle third of
    /// any face.
    pub fn lee(bodies: usize, subdomains: usize, elements: usize, faces: Faces) -> Result<Scene> {
        Scene::new(lee(bodies, subdomains, elements, faces))
    }

    /// A grid of equal bodies, tied wherever they touch.
    ///
    /// # Errors
    /// As [`Scene::new`].
    pub fn grid(title: impl Into<String>, grid: &GridSpec) -> Result<Scene> {
        Scene::new(SceneSpec::tied(title, grid.expand()))
    }

    /// All that users are told of the input.
    pub fn sentences(&self) -> Vec<String> {
        self.notes.iter().chain(&self.asides).cloned().collect()
    }

    /// The dimension, 2 or 3.
    pub fn dim(&self) -> usize {
        self.bodies[0].mesh().dim()
    }

    /// Whether a body is a mesh of cells in space. Boxes are cut regularly.
    pub fn is_ragged(&self) -> bool {
        let cells = |b: &Body| b.mesh().cells().is_some();
        self.dim() == 3 && self.bodies.iter().any(cells)
    }

    /// Whether a whole face ties two bodies node by node; the method may make them one
    /// ([`MergeKind`](fetifeti::settings::MergeKind)).
    pub fn has_whole_ties(&self) -> bool {
        self.interfaces.iter().any(|i| {
            let tied = i.shared.iter().all(|s| s.link == crate::Link::Tied);
            let matching = i.mortar.is_none() && i.unmatched.is_empty();
            tied && matching && !i.shared.is_empty() && i.bodies[0] != i.bodies[1]
        })
    }

    /// Number C of components of the field.
    pub fn components(&self) -> usize {
        self.bodies[0].components
    }

    /// Number of bodies.
    pub fn n_bodies(&self) -> usize {
        self.bodies.len()
    }

    /// Free degrees of freedom, counted once in every body.
    pub fn dofs(&self) -> usize {
        let free = |b: &Body| b.mesh().n_nodes() * b.components - b.prescribed.len();
        self.bodies.iter().map(free).sum()
    }

    /// Number of subdomains of all bodies.
    pub fn n_subdomains(&self) -> usize {
        self.n_subdomains
    }

    /// The body that subdomain `index` belongs to, and the subdomain's number inside it.
    pub fn body_of(&self, index: usize) -> (usize, usize) {
        let body = self
            .bodies
            .partition_point(|b| b.first_subdomain <= index)
            .saturating_sub(1);
        (body, index - self.bodies[body].first_subdomain)
    }
}
