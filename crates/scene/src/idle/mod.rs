//! Motions without energy of meshes with few points of integration: which of them given values stop, which rows see,
//! and which nothing sees at all.
//!
//! Let V be the motions of a body without energy, rigid ones included, that vanish where values are given. Those that
//! rows see are spanned by the rigid ones and a few more, which join the kernel of the body. The rest, V₀, is idle
//! ([`Idle`]): K gets a spring at one degree of freedom of each of a basis of V₀, where the others vanish. What K then
//! does not see of a rigid motion is the rigid motion less the motions of V₀ that are as large where the springs are.

mod basis;
pub(super) mod body;
mod words;

use super::checked::Scene;
use crate::assembly::zero_energy::ZeroEnergyMode;
use body::BodySlack;
use words::{most, REMEDY};

impl Scene {
    /// The motions of the bodies, from those of their meshes; and a note on each body that has some.
    pub(super) fn find_idle(
        &self,
        slack: Vec<(usize, Vec<ZeroEnergyMode>)>,
    ) -> (Vec<BodySlack>, Vec<String>) {
        let (mut out, mut notes) = (Vec::new(), Vec::new());
        if slack.is_empty() {
            return (out, notes);
        }
        let rows = self.solver_rows(&|_| true);
        let mut seen: Vec<u64> = rows
            .iter()
            .flat_map(|r| r.terms.iter().map(|t| t.0))
            .collect();
        seen.sort_unstable();
        seen.dedup();
        for (b, motions) in slack {
            let body = &self.bodies[b];
            let c = body.components;
            let count = body.mesh().n_nodes() * c;
            let own = seen.partition_point(|d| *d < body.first_dof)
                ..seen.partition_point(|d| *d < body.first_dof + count as u64);
            let mut on_rows: Vec<u32> = seen[own]
                .iter()
                .map(|d| (d - body.first_dof) as u32)
                .collect();
            if self.renewal.is_some() {
                // Rows may come anywhere on the boundary.
                let nodes = body.mesh().boundary().into_iter();
                on_rows = nodes
                    .flat_map(|k| (c * k..c * (k + 1)).map(|d| d as u32))
                    .collect();
            }
            let found = BodySlack::new(&self.form, (b, body), motions, &on_rows);
            if found.idle.is_empty() && found.seen.is_empty() {
                continue;
            }
            notes.push(found.note(body));
            out.push(found);
        }
        (out, notes)
    }

    /// The bodies with such motions, and what is to be said of each behind a sentence.
    pub(super) fn weak_bodies(&self) -> Vec<(usize, String)> {
        let of = |slack: &BodySlack| {
            let body = &self.bodies[slack.body];
            let any = slack.idle.iter().chain(&slack.seen).next();
            let (who, node, _) = most(body, any.expect("a motion"));
            let text = format!(
                "in body `{}` {who} leave motions without energy that are not rigid (node {node} moves most in one): \
                 {REMEDY}",
                body.spec.name
            );
            (slack.body, text)
        };
        self.idle.iter().map(of).collect()
    }

    /// The motions of a body beside the rigid ones, if it has some.
    pub(super) fn slack_of(&self, body: usize) -> Option<&BodySlack> {
        self.idle.iter().find(|slack| slack.body == body)
    }
}
