//! Nodes at symmetry planes, walls and fixed planes, for stencils that extend behind them: contributions there are folded
//! to the front, and nodal values there follow from those in front.

use super::fields::Fields;
use super::layout::NodeSums;
use super::ties::Ties;
use crate::dim::{BLOCK, block_nodes};
use crate::grid::levels::pack;
use crate::grid::{GridStorage, Node};
use impactite_scene::boundary::{Boundary, Plane};
use impactite_simd::Float;

/// Indices of a node in front of a plane, one on it and one behind it; [`NOWHERE`] if there is none.
type Column = [u32; 3];

const NOWHERE: u32 = u32::MAX;

/// Columns of nodes through a plane.
#[derive(Clone, Debug)]
struct Columns {
    plane: Plane,
    columns: Vec<Column>,
    /// Columns of rigid bodies: velocities are the body's own, and only masses are folded.
    rigid: Vec<Column>,
}

/// Planes of a scene with their nodes, updated with each arrangement of the grid.
#[derive(Clone, Debug)]
pub struct Planes<T> {
    symmetries: Vec<Columns>,
    /// Planes of `symmetries`.
    mirrors: Vec<Plane>,
    /// True if stencils extend behind symmetry planes; nodes there are then copies of those in front.
    wide: bool,
    /// Indices in `symmetries` of planes with another one cell in front.
    slices: Vec<usize>,
    /// Walls and fixed planes behind which velocities are extrapolated ([`crate::BoundaryModified`]).
    edges: Vec<Columns>,
    /// Nodes in front of and behind symmetry planes, each once.
    beside: Vec<Beside<T>>,
    /// Surfaces of conditions with forces on them, each with the index of its condition.
    surfaces: Vec<(usize, Columns)>,
    /// Shares of a surface for the nodes in front of, on and behind it.
    shares: [f64; 3],
    /// Nodes with a share of a surface: node, condition, and thickness of its mass, m. Sorted.
    depths: Vec<(u32, u32, f64)>,
    /// Nodes at the borders of levels of cells, which depend on those of larger cells.
    pub(in crate::step) ties: Ties<T>,
}

/// Node in front of or behind a symmetry plane.
#[derive(Clone, Copy, Debug)]
struct Beside<T> {
    /// Index of the node.
    node: u32,
    /// True if it is behind a plane: a copy.
    behind: bool,
    /// True for a node of a rigid body.
    rigid: bool,
    /// Node as mapped by particles; later with the stored velocity in `second`.
    mapped: Node<T>,
}

impl<T> Default for Planes<T> {
    fn default() -> Self {
        Planes {
            symmetries: Vec::new(),
            mirrors: Vec::new(),
            wide: false,
            slices: Vec::new(),
            edges: Vec::new(),
            beside: Vec::new(),
            surfaces: Vec::new(),
            shares: [0.0, 1.0, 0.0],
            depths: Vec::new(),
            ties: Ties::default(),
        }
    }
}

impl<T: Float> Planes<T> {
    /// Find the nodes at planes. `wide` is true if stencils extend beyond a plane that particles touch, `modified` if
    /// values behind walls and fixed planes are extrapolated. `shares` are those of a plane for the nodes in front of, on
    /// and behind it; `rigid` are the indices of rigid bodies.
    pub fn arrange<const D: usize>(
        &mut self,
        grid: &dyn GridStorage<T, D>,
        (fields, rigid): (&Fields<D>, &[usize]),
        boundaries: &[Boundary<D>],
        [wide, modified]: [bool; 2],
        shares: [f64; 3],
    ) {
        let lattice = *grid.lattice();
        self.ties.arrange(grid, fields);
        let with_columns = |plane| {
            let is_rigid = |&(_, owner): &(Column, u32)| rigid.contains(&(owner as usize));
            let (of_rigid, others): (Vec<_>, Vec<_>) =
                columns(grid, fields, plane).into_iter().partition(is_rigid);
            let [columns, rigid] =
                [others, of_rigid].map(|all| all.into_iter().map(|(column, _)| column).collect());
            Columns { plane, columns, rigid }
        };
        self.symmetries = boundaries.iter().filter_map(|b| b.mirror(&lattice)).map(with_columns).collect();
        self.mirrors.clear();
        self.mirrors.extend(self.symmetries.iter().map(|s| s.plane));
        self.wide = wide;
        self.beside.clear();
        if wide {
            for Columns { columns, rigid, .. } in &self.symmetries {
                for (columns, rigid) in [(columns, false), (rigid, true)] {
                    let both = columns.iter().filter(is_pair).flat_map(|c| [(c[0], false), (c[2], true)]);
                    let mapped = Node::default();
                    self.beside.extend(both.map(|(node, behind)| Beside { node, behind, rigid, mapped }));
                }
            }
            // A node may be in front of one plane and behind another.
            self.beside.sort_unstable_by_key(|b| (b.node, !b.behind));
            self.beside.dedup_by_key(|b| b.node);
        }
        let mirrors = self.copied();
        let closed = |m: &Plane| mirrors.iter().any(|o| o.axis == m.axis && o.node == m.node + m.sign);
        let slices = (0..mirrors.len()).filter(|&i| closed(&mirrors[i])).collect();
        self.slices = slices;
        self.shares = shares;
        self.surfaces.clear();
        for (n, boundary) in boundaries.iter().enumerate() {
            self.surfaces.extend(boundary.surface_on(&lattice).map(|plane| (n, with_columns(plane))));
        }
        self.edges.clear();
        if wide && modified {
            self.edges.extend(boundaries.iter().filter_map(|b| b.edge(&lattice)).map(with_columns));
        }
    }

    /// Return true if nothing is folded.
    pub fn is_empty(&self) -> bool {
        self.symmetries.is_empty()
            && self.edges.is_empty()
            && self.surfaces.is_empty()
            && self.ties.is_empty()
    }

    /// Return the thickness of a node's mass at the surface of a condition, by the indices of both, m; none without a
    /// share.
    pub(in crate::step) fn depth(&self, node: usize, condition: usize) -> Option<f64> {
        let key = (node as u32, condition as u32);
        let found = self.depths.binary_search_by_key(&key, |&(node, condition, _)| (node, condition)).ok()?;
        Some(self.depths[found].2)
    }

    /// Distribute the surfaces of conditions. The mass of a node on a surface is that of half a cell in front of it, for
    /// any shape function; this much of the surface belongs to the node and to its neighbours across the plane.
    fn share_surfaces(&mut self, nodes: &[Node<T>], spacing: f64) {
        let Planes { surfaces, shares, depths, .. } = self;
        depths.clear();
        for (condition, Columns { columns, rigid, .. }) in surfaces.iter() {
            for column in columns.iter().chain(rigid).filter(|c| c[1] != NOWHERE) {
                let on = nodes[column[1] as usize].first[0].to_double();
                for (&node, &share) in
                    column.iter().zip(&*shares).filter(|(n, s)| **n != NOWHERE && **s > 0.0)
                {
                    let mass = nodes[node as usize].first[0].to_double();
                    let depth = 0.5 * spacing * mass / (share * on);
                    depths.push((node, *condition as u32, depth));
                }
            }
        }
        depths.sort_unstable_by_key(|&(node, condition, _)| (node, condition));
    }

    /// Symmetry planes.
    pub(crate) fn mirrors(&self) -> &[Plane] {
        &self.mirrors
    }

    /// Symmetry planes that stencils extend behind: nodes there are copies.
    pub(crate) fn copied(&self) -> &[Plane] {
        if self.wide { &self.mirrors } else { &[] }
    }

    /// Axes of the symmetry planes that mirror nodes.
    pub(in crate::step) fn mirrored_axes(&self) -> [bool; 3] {
        std::array::from_fn(|axis| self.copied().iter().any(|m| m.axis == axis))
    }

    /// Fold the contributions at planes: add those of the body's mirror half, or those behind edges. `moves` are the
    /// factors of first\[i\] and second\[i\] of a node in the momentum of particles. Next to symmetry planes the normal
    /// component of `weight`, m/s^2, acts as a force on the mass that particles mapped there themselves, so that it acts
    /// mirrored on their images. Returns the impulse of the symmetry planes, N s, and its part from the first records.
    pub fn fold(
        &mut self,
        nodes: &mut [Node<T>],
        sums: NodeSums,
        moves: &impl Fn(u32) -> [T; 2],
        (cutoff, spacing): (T, f64),
        weight: Option<[f64; 3]>,
    ) -> [[f64; 3]; 2] {
        let (mut impulse, mut of_first) = ([0.0; 3], [0.0; 3]);
        let first = |moves: [T; 2]| [moves[0], T::default()];
        if let Some(weight) = weight {
            let across = self.mirrored_axes();
            for Beside { node, mapped, .. } in self.beside.iter().filter(|b| !b.rigid) {
                let node = &mut nodes[*node as usize];
                let own = if sums == NodeSums::All { node.first[0] } else { mapped.first[0] };
                for axis in (0..3).filter(|a| across[*a]) {
                    node.second[1 + axis] += own * T::of(weight[axis]);
                }
            }
        }
        for Columns { plane, columns, .. } in &self.symmetries {
            for on in columns.iter().map(|c| c[1]).filter(|&n| n != NOWHERE) {
                let node = &mut nodes[on as usize];
                if sums == NodeSums::All {
                    of_first[plane.axis] -= (moves(on)[0] * node.first[1 + plane.axis]).to_double();
                }
                impulse[plane.axis] += still(node, plane.axis, sums, moves(on));
            }
        }
        for Beside { node, mapped, .. } in &mut self.beside {
            match sums {
                NodeSums::All => *mapped = nodes[*node as usize],
                _ => mapped.second = nodes[*node as usize].second,
            }
        }
        // Two planes may be two cells apart and share the nodes between them: first add, then copy.
        for fold in [give_mirrored, copy_mirrored] {
            for Columns { plane, columns, .. } in self.symmetries.iter().filter(|_| self.wide) {
                for &[front, _, back] in columns.iter().filter(is_pair) {
                    fold(nodes, front as usize, back as usize, plane.axis, sums);
                }
            }
        }
        if self.wide && sums == NodeSums::All {
            self.fold_masses_of_rigid(nodes);
        }
        self.close_slices(nodes, sums);
        for Beside { node, mapped, .. } in self.beside.iter().filter(|b| !b.rigid) {
            let folded = &nodes[*node as usize];
            if folded.first[0] > cutoff {
                for axis in (0..3).filter(|a| self.mirrors.iter().any(|p| p.axis == *a)) {
                    impulse[axis] += folded_impulse(mapped, folded, axis, moves(*node));
                    of_first[axis] += folded_impulse(mapped, folded, axis, first(moves(*node)));
                }
            }
        }
        for column in self.edges.iter().flat_map(|e| &e.columns) {
            fold_extrapolated(nodes, *column, sums);
        }
        if sums == NodeSums::All && !self.surfaces.is_empty() {
            self.share_surfaces(nodes, spacing);
        }
        [impulse, of_first]
    }

    /// Fold the masses of nodes of rigid bodies next to symmetry planes, which include the body's image.
    fn fold_masses_of_rigid(&self, nodes: &mut [Node<T>]) {
        for copy in [false, true] {
            for &[front, _, back] in self.symmetries.iter().flat_map(|s| &s.rigid).filter(is_pair) {
                let [front, back] = [front, back].map(|n| n as usize);
                if copy {
                    nodes[back].first[0] = nodes[front].first[0];
                } else {
                    let behind = nodes[back].first[0];
                    nodes[front].first[0] += behind;
                }
            }
        }
    }

    /// Zero normal components between two symmetry planes one cell apart, where values folded in front of one plane are on
    /// the other.
    fn close_slices(&self, nodes: &mut [Node<T>], sums: NodeSums) {
        for Columns { plane, columns, .. } in self.slices.iter().map(|&i| &self.symmetries[i]) {
            let across = 1 + plane.axis;
            for n in columns.iter().flat_map(|c| [c[0], c[2]]).filter(|&n| n != NOWHERE) {
                if sums == NodeSums::All {
                    nodes[n as usize].first[across] = T::default();
                }
                nodes[n as usize].second[across] = T::default();
            }
        }
    }

    /// Store the velocities in front of and behind symmetry planes, before contact changes them.
    pub fn note_velocities(&mut self, nodes: &[Node<T>]) {
        for Beside { node, mapped, .. } in &mut self.beside {
            mapped.second = nodes[*node as usize].first;
        }
    }

    /// Copy velocities changed by contact in front of symmetry planes to the nodes behind. Returns the impulse of the
    /// planes, N s: the effect of the changes since [`Planes::note_velocities`] on the particles, less that on the nodes in
    /// front. `counts` is true for a node whose body's momentum is counted. Behind the plane a rigid body has its own
    /// velocities, and only the change is mirrored; with `per_dt`, 1/s, that of its accelerations, too.
    pub fn copy_velocities(
        &self,
        nodes: &mut [Node<T>],
        cutoff: T,
        counts: &impl Fn(u32) -> bool,
        per_dt: Option<T>,
    ) -> [f64; 3] {
        let mut impulse = [0.0; 3];
        if !self.wide {
            return impulse;
        }
        for Columns { plane, columns, rigid } in &self.symmetries {
            for &[front, _, back] in rigid.iter().filter(is_pair) {
                let Some([before, behind]) = self.noted(front).zip(self.noted(back)).map(|(f, b)| [f, b])
                else {
                    continue;
                };
                let now = nodes[front as usize].first;
                let change = mirrored(std::array::from_fn(|i| now[i] - before[i]), plane.axis);
                let node = &mut nodes[back as usize];
                for d in 1..4 {
                    let then = behind[d] + change[d];
                    let more = then - node.first[d];
                    node.first[d] = then;
                    if let Some(per_dt) = per_dt {
                        node.second[d] += more * per_dt;
                    }
                }
            }
            for &[front, _, back] in columns.iter().filter(is_pair) {
                let mass = nodes[back as usize].first[0];
                copy_mirrored(nodes, front as usize, back as usize, plane.axis, NodeSums::All);
                nodes[back as usize].first[0] = mass;
            }
        }
        for Beside { node, behind, mapped, .. } in &self.beside {
            let now = &nodes[*node as usize];
            if now.first[0] <= cutoff || !counts(*node) {
                continue;
            }
            let whole = if *behind { T::default() } else { now.first[0] };
            for (axis, impulse) in impulse.iter_mut().enumerate() {
                let change = now.first[1 + axis] - mapped.second[1 + axis];
                *impulse += ((mapped.first[0] - whole) * change).to_double();
            }
        }
        impulse
    }

    /// Return the stored velocity of a node next to planes.
    fn noted(&self, node: u32) -> Option<[T; 4]> {
        let found = self.beside.binary_search_by_key(&node, |b| b.node).ok()?;
        Some(self.beside[found].mapped.second)
    }

    /// Extrapolate nodal vectors to the nodes behind walls and fixed planes.
    pub fn extrapolate(&self, nodes: &mut [Node<T>]) {
        for column in self.edges.iter().flat_map(|e| &e.columns).filter(|c| !c.contains(&NOWHERE)) {
            let [front, on, back] = column.map(|n| n as usize);
            let two = T::of(2.0);
            for d in 1..4 {
                nodes[back].first[d] = two * nodes[on].first[d] - nodes[front].first[d];
                nodes[back].second[d] = two * nodes[on].second[d] - nodes[front].second[d];
            }
        }
    }

    /// Return the masses mapped by the body's own particles to the nodes `start..start + count` that also represent its
    /// image.
    pub(in crate::step) fn own_masses(&self, start: usize, count: usize) -> OwnMasses<'_, T> {
        let place = |node: usize| self.beside.partition_point(|b| (b.node as usize) < node);
        let beside =
            if self.beside.is_empty() { &[][..] } else { &self.beside[place(start)..place(start + count)] };
        OwnMasses { start, beside, next: 0 }
    }

    /// Allocated memory, bytes.
    pub fn bytes(&self) -> usize {
        let of = |c: &Columns| c.columns.capacity() + c.rigid.capacity();
        let columns = self.symmetries.iter().chain(&self.edges).map(of).sum::<usize>();
        let surfaces = self.surfaces.iter().map(|(_, c)| of(c)).sum::<usize>();
        (columns + surfaces) * size_of::<Column>()
            + self.depths.capacity() * size_of::<(u32, u32, f64)>()
            + self.ties.bytes()
            + self.beside.capacity() * size_of::<Beside<T>>()
    }
}

/// Masses mapped by a body's own particles to nodes next to symmetry planes.
pub(in crate::step) struct OwnMasses<'a, T> {
    start: usize,
    beside: &'a [Beside<T>],
    /// Index in `beside` of the next node, for visits in order.
    next: usize,
}

impl<T: Float> OwnMasses<'_, T> {
    /// Return the share of the `i`-th node's mass that its own particles mapped; they receive the same share of all changes
    /// of the node. The rest belongs to its images, mirrored. None for a node without images.
    pub(in crate::step) fn share(&self, i: usize, node: &Node<T>) -> Option<f64> {
        let found = self.beside.binary_search_by_key(&(self.start + i), |b| b.node as usize).ok()?;
        Some(part(&self.beside[found], node))
    }
    /// Return [`OwnMasses::share`] of nodes visited in ascending order, each at most once.
    pub(in crate::step) fn next_share(&mut self, i: usize, node: &Node<T>) -> Option<f64> {
        let beside = self.beside.get(self.next).filter(|b| b.node as usize == self.start + i)?;
        self.next += 1;
        Some(part(beside, node))
    }
}

/// Return the part of a node's mass that was mapped by the body's own particles.
fn part<T: Float>(beside: &Beside<T>, node: &Node<T>) -> f64 {
    let (own, all) = (beside.mapped.first[0], node.first[0]);
    if all > T::default() { (own / all).to_double() } else { 0.0 }
}

/// Return true if the column has nodes on both sides.
fn is_pair(column: &&Column) -> bool {
    column[0] != NOWHERE && column[2] != NOWHERE
}

/// Return the columns of nodes through a plane, separately for each body's field, with the owner.
fn columns<T: Float, const D: usize>(
    grid: &dyn GridStorage<T, D>,
    fields: &Fields<D>,
    plane: Plane,
) -> Vec<(Column, u32)> {
    let levels = fields.levels().map_or(1, |levels| levels.count());
    (0..levels).flat_map(|level| columns_on(grid, fields, plane, level)).collect()
}

/// Return the columns of nodes of a level through a plane.
fn columns_on<T: Float, const D: usize>(
    grid: &dyn GridStorage<T, D>,
    fields: &Fields<D>,
    Plane { axis, node, sign }: Plane,
    level: usize,
) -> Vec<(Column, u32)> {
    let (node, between) = fields.lattices().node_at_plane(level, node, sign);
    let layers = if between { [node, node, node - sign] } else { [node + sign, node, node - sign] };
    let block_of = |layer: i32| layer.div_euclid(BLOCK as i32);
    let stride = BLOCK.pow(axis as u32);
    // List each column of blocks of a body once, with the coordinate along the axis set to zero.
    let mut places: Vec<([i32; D], u32)> = Vec::new();
    for (block, c) in fields.coordinates().iter().enumerate() {
        let (of, c) = fields.lattices().leveled(c);
        if of == level && layers.iter().any(|&l| block_of(l) == c[axis]) {
            let mut place = c;
            place[axis] = 0;
            places.push((place, fields.owner(block)));
        }
    }
    places.sort_unstable();
    places.dedup();
    let mut columns = Vec::new();
    for (place, owner) in places {
        let blocks = layers.map(|layer| {
            let mut c = place;
            c[axis] = block_of(layer);
            fields.find(grid, &pack(level, c), owner)
        });
        for n in (0..block_nodes(D)).filter(|n| (n / stride).is_multiple_of(BLOCK)) {
            let column = std::array::from_fn(|i| {
                if between && i == 1 {
                    return NOWHERE;
                }
                let within = layers[i].rem_euclid(BLOCK as i32) as usize * stride;
                let place = blocks[i].and_then(|b| fields.layout().place(b, n + within));
                place.map_or(NOWHERE, |place| place as u32)
            });
            columns.push((column, owner));
        }
    }
    columns
}

/// Zero the normal momentum and force of a node on a symmetry plane, which the other half of the body cancels, before any
/// division or difference. Returns the impulse of the plane, N s: the cancelled amount.
fn still<T: Float>(node: &mut Node<T>, axis: usize, sums: NodeSums, moves: [T; 2]) -> f64 {
    let mut impulse = -(moves[1] * std::mem::take(&mut node.second[1 + axis])).to_double();
    if sums == NodeSums::All {
        impulse -= (moves[0] * std::mem::take(&mut node.first[1 + axis])).to_double();
    }
    impulse
}

/// Return the impulse of symmetry planes through a node next to them, N s: contribution of the folded node to the
/// particles, less that of the particles to the node.
fn folded_impulse<T: Float>(mapped: &Node<T>, folded: &Node<T>, axis: usize, moves: [T; 2]) -> f64 {
    let records = |n: &Node<T>| moves[0] * n.first[1 + axis] + moves[1] * n.second[1 + axis];
    (mapped.first[0] / folded.first[0] * records(folded) - records(mapped)).to_double()
}

/// Add the node behind a symmetry plane, mirrored, to the one in front: the contribution of the body's other half.
fn give_mirrored<T: Float>(nodes: &mut [Node<T>], front: usize, back: usize, axis: usize, sums: NodeSums) {
    let sum = |a: [T; 4], b: [T; 4]| [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]];
    if sums == NodeSums::All {
        nodes[front].first = sum(nodes[front].first, mirrored(nodes[back].first, axis));
    }
    nodes[front].second = sum(nodes[front].second, mirrored(nodes[back].second, axis));
}

/// Copy the node in front of a symmetry plane, mirrored, to the one behind: the image of this half of the body.
fn copy_mirrored<T: Float>(nodes: &mut [Node<T>], front: usize, back: usize, axis: usize, sums: NodeSums) {
    if sums == NodeSums::All {
        nodes[back].first = mirrored(nodes[front].first, axis);
    }
    nodes[back].second = mirrored(nodes[front].second, axis);
}

fn mirrored<T: Float>(mut record: [T; 4], axis: usize) -> [T; 4] {
    record[1 + axis] = -record[1 + axis];
    record
}

/// Redistribute contributions behind an edge to the nodes of the extrapolation: the adjoint of v_back = 2 v_on - v_front.
/// The basis then ends at the edge: at the edge's nodes it interpolates (Steffen, Kirby, Berzins 2008).
fn fold_extrapolated<T: Float>(nodes: &mut [Node<T>], column: Column, sums: NodeSums) {
    if column.contains(&NOWHERE) {
        return;
    }
    let [front, on, back] = column.map(|n| n as usize);
    let two = T::of(2.0);
    for i in 0..4 {
        if sums == NodeSums::All {
            let behind = std::mem::take(&mut nodes[back].first[i]);
            nodes[on].first[i] += two * behind;
            nodes[front].first[i] -= behind;
        }
        let behind = std::mem::take(&mut nodes[back].second[i]);
        nodes[on].second[i] += two * behind;
        nodes[front].second[i] -= behind;
    }
}
