//! Connected pieces of a body.

/// Connected pieces of a body: elements that share particles, directly or through others. `corners` are the `D + 1` particles of each
/// element, as in [`crate::Pcmm::element_nodes`], numbered below `particles`. Return the numbers of the elements of each piece, ascending;
/// the largest piece first, of equal ones that with the first particle.
pub fn pieces<const D: usize>(corners: &[u32], particles: usize) -> Vec<Vec<u32>> {
    let mut root: Vec<u32> = (0..particles as u32).collect();
    for element in corners.chunks_exact(D + 1) {
        for &corner in &element[1..] {
            let (a, b) = (find(&mut root, element[0]), find(&mut root, corner));
            root[a.max(b) as usize] = a.min(b);
        }
    }
    let mut of_root: Vec<Vec<u32>> = vec![Vec::new(); particles];
    for (e, element) in corners.chunks_exact(D + 1).enumerate() {
        of_root[find(&mut root, element[0]) as usize].push(e as u32);
    }
    of_root.retain(|elements| !elements.is_empty());
    of_root.sort_by_key(|elements| std::cmp::Reverse(elements.len()));
    of_root
}

fn find(root: &mut [u32], mut n: u32) -> u32 {
    while root[n as usize] != n {
        root[n as usize] = root[root[n as usize] as usize];
        n = root[n as usize];
    }
    n
}

#[cfg(test)]
mod tests {
    use super::pieces;

    #[test]
    fn elements_that_share_a_particle_are_one_piece() {
        // A lone triangle, two that share a corner, another lone one; particle 2 in none.
        let corners = [7, 3, 8, 0, 1, 4, 4, 5, 6, 9, 10, 11];
        assert_eq!(pieces::<2>(&corners, 12), [vec![1, 2], vec![0], vec![3]]);
        assert!(pieces::<2>(&[], 3).is_empty());
        assert_eq!(pieces::<3>(&[0, 1, 2, 3, 3, 4, 5, 6], 7), [vec![0, 1]]);
    }
}
