//! Disjoint sets with known differences between their members, by union and find.

/// Disjoint sets of 0..n with known differences between the members.
#[derive(Debug, Clone)]
pub struct Potentials {
    parent: Vec<usize>,
    /// u of a member minus u of its parent.
    above: Vec<f64>,
}

impl Potentials {
    /// n sets of one member.
    pub fn new(n: usize) -> Potentials {
        Potentials {
            parent: (0..n).collect(),
            above: vec![0.0; n],
        }
    }

    /// The representative of the set of `k`, and u_k minus u there.
    pub fn find(&mut self, k: usize) -> (usize, f64) {
        let (mut root, mut sum) = (k, 0.0);
        while self.parent[root] != root {
            sum += self.above[root];
            root = self.parent[root];
        }
        (self.parent[k], self.above[k]) = (root, sum);
        (root, sum)
    }

    /// Imposes u_a − u_b = c. Where both are in the same set already, returns by how much their difference misses c.
    pub fn join(&mut self, a: usize, b: usize, c: f64) -> Option<f64> {
        let ((root_a, u_a), (root_b, u_b)) = (self.find(a), self.find(b));
        if root_a == root_b {
            return Some(u_a - u_b - c);
        }
        self.parent[root_a] = root_b;
        self.above[root_a] = c - u_a + u_b;
        None
    }
}
