//! Where states wander, of each contact only the nodes that are most wrong change their states: all of them at once go
//! too far, and back in the next step.

use super::node::Step;
use super::Friction;
use std::collections::HashMap;

impl Friction<'_> {
    /// Whether each node waits, because others of its contact are far more wrong after a step.
    pub(super) fn waiting(&self, step: &Step<'_>) -> Vec<bool> {
        let (dual, rows) = (self.method.dual(), &self.method.problem.rows);
        let jump = &dual.stiffness.jump;
        let before = &self.inner.state.before;
        let least = self.settings.tuning.friction.most_wrong;
        let wrong = self.nodes.iter().map(|node| {
            let source = rows[jump.given(node.normal)].label.source;
            (source.code(), node.wrong(step, before[node.normal]))
        });
        let wrong: Vec<([usize; 2], f64)> = wrong.collect();
        let mut worst: HashMap<[usize; 2], f64> = HashMap::new();
        for (source, wrong) in &wrong {
            let most = worst.entry(*source).or_default();
            *most = most.max(*wrong);
        }
        let waits = wrong
            .iter()
            .map(|(source, wrong)| *wrong > 0.0 && *wrong < least * worst[source]);
        waits.collect()
    }
}
