//! Parts of the subdomains of a set-up that are kept for the next one: factors where only rows between bodies are
//! replaced, analyses of patterns where matrices have other numbers, too.

use std::sync::Arc;

use super::scaled::ScaledSubdomain;
use super::which::OperatorForm;
use crate::feti::interface::entities::Average;
use crate::feti::jump::operator::Jump;
use crate::feti::primal::body::AnalysedPattern;
use cholesky::interior::Analysed;

/// The subdomains of a set-up, each with the interface that it was factored for.
pub(crate) struct RetainedFactors {
    interfaces: Vec<SubdomainInterface>,
    forms: Vec<OperatorForm>,
    /// `None`: the matrices have other numbers.
    locals: Option<Vec<ScaledSubdomain>>,
    analysed: Vec<Option<Arc<Analysed>>>,
    coarse: Vec<AnalysedPattern>,
}

/// The kept parts of one subdomain that are still right in the next set-up.
#[derive(Default)]
pub(crate) struct Still {
    /// The form of its operators.
    pub form: Option<OperatorForm>,
    /// All of it.
    pub whole: Option<ScaledSubdomain>,
    /// Analyses of its pattern and interface.
    pub analysed: Option<Arc<Analysed>>,
}

/// The data beside its matrix on which the operators of a subdomain depend.
#[derive(PartialEq)]
struct SubdomainInterface {
    delta: Vec<u32>,
    primal: Vec<u32>,
    averages: Vec<Average>,
}

impl SubdomainInterface {
    fn of(jump: &Jump, j: usize) -> SubdomainInterface {
        SubdomainInterface {
            delta: jump.delta[j].clone(),
            primal: jump.primal[j].clone(),
            averages: jump.averages[j].clone(),
        }
    }
}

impl RetainedFactors {
    /// The subdomains `locals` of a set-up with these rows, and the analyses of their patterns and of the `coarse`
    /// problems of bodies, as far as there are any.
    pub fn new(
        jump: &Jump,
        locals: &[ScaledSubdomain],
        analysed: &[Option<Arc<Analysed>>],
        coarse: Vec<AnalysedPattern>,
    ) -> RetainedFactors {
        let form = |local: &ScaledSubdomain| {
            if local.is_implicit() {
                OperatorForm::Implicit
            } else {
                OperatorForm::Explicit
            }
        };
        RetainedFactors {
            interfaces: (0..locals.len())
                .map(|j| SubdomainInterface::of(jump, j))
                .collect(),
            forms: locals.iter().map(form).collect(),
            locals: Some(locals.to_vec()),
            analysed: analysed.to_vec(),
            coarse,
        }
    }

    /// The kept parts without the factors, for matrices with the same patterns and other numbers.
    pub fn patterns(self) -> RetainedFactors {
        RetainedFactors {
            locals: None,
            ..self
        }
    }

    /// The patterns of the coarse problems of this rank's bodies. They may be those of other rows.
    pub fn coarse(&self) -> &[AnalysedPattern] {
        &self.coarse
    }

    /// The parts of each local subdomain that are still right with other rows: nothing where its interface has changed.
    pub fn still(&self, jump: &Jump) -> Vec<Still> {
        let of = |(j, interface): (usize, &SubdomainInterface)| {
            if *interface != SubdomainInterface::of(jump, j) {
                Still::default()
            } else {
                Still {
                    form: Some(self.forms[j]),
                    whole: self.locals.as_ref().map(|l| l[j].clone()),
                    analysed: self.analysed[j].clone(),
                }
            }
        };
        self.interfaces.iter().enumerate().map(of).collect()
    }
}
