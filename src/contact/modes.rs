//! Modes of the operators, for as long as a search needs them. A guard ends its mode when it is dropped, however the
//! search has ended.

use crate::feti::LinearMethod;

/// The rows of a method as springs; they are rigid again afterwards.
pub struct CompliantRows<'a>(&'a LinearMethod);

impl<'a> CompliantRows<'a> {
    /// The rows of `method`, as they are.
    pub fn of(method: &'a LinearMethod) -> CompliantRows<'a> {
        CompliantRows(method)
    }

    /// Makes the rows springs with this compliance. Collective.
    pub fn soften(&self, compliance: &[f64]) {
        self.0.system.set_compliance(Some(compliance.to_vec()));
    }

    /// Makes the rows rigid. Collective.
    pub fn rigid(&self) {
        self.0.system.set_compliance(None);
    }
}

impl Drop for CompliantRows<'_> {
    fn drop(&mut self) {
        // A panic may have left the operators in the middle of something.
        if !std::thread::panicking() {
            self.rigid();
        }
    }
}

/// A face of the bounds, in which M⁻¹ knows the free rows only; afterwards the rows hold that held before.
pub struct Face<'a> {
    method: &'a LinearMethod,
    /// The rows that held, once a face was entered.
    held: Option<Vec<bool>>,
}

impl<'a> Face<'a> {
    /// The rows of `method`, as they are.
    pub fn of(method: &'a LinearMethod) -> Face<'a> {
        Face { method, held: None }
    }

    /// Enters the face in which these rows are free. Collective.
    pub fn enter(&mut self, free: &[bool]) {
        let held = || self.method.dual().stiffness.jump.active.clone();
        self.held.get_or_insert_with(held);
        self.method.system.set_face(free);
    }

    /// Forgets the rows that held, where other rows are set at once.
    pub fn forget(&mut self) {
        self.held = None;
    }

    /// Leaves the face: the rows hold that held before it was entered. Collective.
    pub fn leave(&mut self) {
        if let Some(held) = self.held.take() {
            self.method.system.set_face(&held);
        }
    }
}

impl Drop for Face<'_> {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.leave();
        }
    }
}
