//! Springs in the rows, for as long as a search needs them.

use crate::feti::LinearMethod;

/// The rows of a method, which are rigid again when this is dropped, however the search has ended.
pub struct CompliantRows<'a>(&'a LinearMethod);

impl<'a> CompliantRows<'a> {
    /// The rows of `method`, as they are.
    pub fn of(method: &'a LinearMethod) -> CompliantRows<'a> {
        CompliantRows(method)
    }

    /// Makes the rows springs with this compliance.
    pub fn soften(&self, compliance: &[f64]) {
        self.0.system.set_compliance(Some(compliance.to_vec()));
    }

    /// Makes the rows rigid.
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
