//! The smallest vertex cover of a bipartite graph. It gives the smallest separator that a cut of a graph allows.
//!
//! By König's theorem a smallest cover has as many vertices as a largest matching has edges. Let Z be the set of
//! vertices that alternating paths reach from unmatched left vertices; an alternating path goes from right to left
//! along matched edges only. Then (left \ Z) ∪ (right ∩ Z) is a smallest cover.

const FREE: u32 = u32::MAX;

/// Marks the cover on both sides; `edges` has the right neighbours of each left vertex. The cover is the left side
/// where every left vertex is matched.
pub fn smallest(edges: &[Vec<u32>], n_right: usize) -> (Vec<bool>, Vec<bool>) {
    let mut matching = BipartiteMatching {
        edges,
        of_left: vec![FREE; edges.len()],
        of_right: vec![FREE; n_right],
        visited: vec![FREE; n_right],
        round: 0,
    };
    // A greedy matching takes most vertices; augmenting paths add the rest.
    for (l, of) in edges.iter().enumerate() {
        let free = |r: &&u32| matching.of_right[**r as usize] == FREE;
        if let Some(&r) = of.iter().find(free) {
            matching.pair(l, r);
        }
    }
    for l in 0..edges.len() {
        if matching.of_left[l] == FREE {
            matching.augment(l);
        }
    }
    matching.cover()
}

struct BipartiteMatching<'a> {
    edges: &'a [Vec<u32>],
    of_left: Vec<u32>,
    of_right: Vec<u32>,
    /// The round in which a right vertex was seen last.
    visited: Vec<u32>,
    round: u32,
}

impl BipartiteMatching<'_> {
    fn pair(&mut self, l: usize, r: u32) {
        self.of_left[l] = r;
        self.of_right[r as usize] = l as u32;
    }

    /// Looks breadth first for an augmenting path from the unmatched left vertex `start`, and swaps its edges.
    fn augment(&mut self, start: usize) {
        let round = self.round;
        self.round += 1;
        // The edges of the paths, as (left, right, previous edge), and the left vertices with the edge that led to
        // them.
        let mut steps: Vec<(usize, u32, u32)> = Vec::new();
        let mut queue = vec![(start, FREE)];
        let mut head = 0;
        while let Some(&(l, before)) = queue.get(head) {
            head += 1;
            for &r in &self.edges[l] {
                if std::mem::replace(&mut self.visited[r as usize], round) == round {
                    continue;
                }
                let here = steps.len() as u32;
                steps.push((l, r, before));
                match self.of_right[r as usize] {
                    FREE => return self.swap(&steps),
                    next => queue.push((next as usize, here)),
                }
            }
        }
    }

    /// Swaps matched and unmatched edges along the path that ends with the last step.
    fn swap(&mut self, steps: &[(usize, u32, u32)]) {
        let mut at = steps.len() - 1;
        loop {
            let (l, r, before) = steps[at];
            self.pair(l, r);
            if before == FREE {
                return;
            }
            at = before as usize;
        }
    }

    fn cover(&self) -> (Vec<bool>, Vec<bool>) {
        let mut left = vec![true; self.edges.len()];
        let mut right = vec![false; self.of_right.len()];
        let free = (0..left.len()).filter(|&l| self.of_left[l] == FREE);
        let mut queue: Vec<usize> = free.collect();
        while let Some(l) = queue.pop() {
            left[l] = false;
            for &r in &self.edges[l] {
                if !std::mem::replace(&mut right[r as usize], true) {
                    // The vertex is matched, or there would be an augmenting path.
                    queue.push(self.of_right[r as usize] as usize);
                }
            }
        }
        (left, right)
    }
}

#[cfg(test)]
#[path = "../tests/cover.rs"]
mod tests;
