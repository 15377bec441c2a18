"""J M^-1 J^T by dense blocks: one for each joint, and one for two joints of a body.

Joints are eliminated in a fixed order (`stiffmbs.dynamics.elimination.joint_blocks`).  For trees, the cost is linear in the
number of joints, as for the articulated-body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 7).

With j = J M^-1/2 and S = j j^T, a row of blocks of S is the panel of a joint.  Its elimination S = L D L^T replaces the
diagonal block by its factors and the right blocks U by V = L^-1 U; D^-1 V, the `scaled` blocks, updates later panels.
"""

from stiffmbs.compile.machine.native.access import compiled, row_of, shifted, view_of
from stiffmbs.compile.machine.native.joint_rows import add_rows, take_rows
from stiffmbs.compile.machine.native.simd import (
    add_products,
    by_case,
    plus_product,
    quad,
    set_quad,
    spread,
    sum_of,
    take_products,
)
from stiffmbs.compile.machine.native.symmetric_factors import (
    complete_vector,
    eliminate_node,
    eliminate_rows,
    eliminate_vector,
    factor_symmetric,
)
from stiffmbs.dynamics.elimination.native.digits import keeps_digits
from stiffmbs.dynamics.elimination.native.layouts import (
    BLOCK_ELIMINATION,
    MOST_ROWS,
    BlockProduct,
    CopiedBlock,
    DiagonalBlock,
    EntryProduct,
    FullBlock,
    JointPanel,
    PanelUpdate,
    SingleEntry,
)

blocks_view = view_of("BlockElimination", BLOCK_ELIMINATION)
block_product = row_of(BlockProduct)
copied_block = row_of(CopiedBlock)
entry_product = row_of(EntryProduct)
joint_panel = row_of(JointPanel)
panel_update = row_of(PanelUpdate)
single_entry = row_of(SingleEntry)
SIZES = {size: (size,) for size in (5, 2, 3, 6)}
"""Sizes of blocks for which loops are unrolled: revolute joints, pairs of equations, spherical and fixed joints."""
SHAPES = {2 * lines - (2 - quads): (lines, quads) for lines in range(MOST_ROWS, 0, -1) for quads in (2, 1)}
"""Lines and quads of the part of a product that fits into registers, by its shape."""
formed = by_case(add_products, SHAPES)
"""Compute into += a^T b for lines of a shape; the depth is the last argument."""
taken = by_case(take_products, SHAPES)
"""Compute into -= a^T b for lines of a shape."""


@compiled
def _clear(numbers, count):
    """Set the first `count` numbers, a multiple of four, to zero."""
    for k in range(0, count, 4):
        set_quad(numbers, k, spread(0.0))


@compiled
def _add_forces(r, b):
    """Add j a of the entries outside regular blocks to x."""
    for k in range(b.n_single):
        e = single_entry(b.single, k)
        b.x[e.x] += b.j[e.j] * r.a[e.velocity]
    for k in range(b.n_copied):
        c = copied_block(b.copied, k)
        j, a = shifted(b.j, c.j), shifted(r.a, c.velocity)
        for at in range(0, c.width, 4):
            total = plus_product(quad(b.x, c.x + at), spread(a[0]), quad(j, at))
            total = plus_product(total, spread(a[1]), quad(j, c.width + at))
            set_quad(b.x, c.x + at, plus_product(total, spread(a[2]), quad(j, 2 * c.width + at)))


@compiled
def _assemble(r, b, values):
    """Assemble S = j j^T by blocks, and x = j a - gamma with a = M^-1/2 f."""
    _clear(b.x, b.n_x)
    for k in range(b.n_gamma):
        b.x[b.gamma_place[k]] -= values[b.gamma_source[k]]
    for k in range(b.n_first):  # entries outside regular blocks; those that share a place are added
        b.j[b.j_at[k]] = values[b.j_source[k]] * b.j_scale[k]
    for k in range(b.n_first, b.n_j):
        b.j[b.j_at[k]] += values[b.j_source[k]] * b.j_scale[k]
    _clear(b.blocks, b.n_panels)
    add_full_blocks(r, b, values)
    add_diagonal_blocks(r, b, values)
    _add_forces(r, b)
    for k in range(b.n_single_products):
        e = entry_product(b.single_product, k)
        b.blocks[e.target] += b.j[e.first] * b.j[e.second]
    for k in range(b.n_products):
        p = block_product(b.product, k)
        first, second = shifted(b.j, p.first), shifted(b.j, p.second)
        formed(p.shape, shifted(b.blocks, p.target), p.stride, first, p.first_stride, second, p.second_stride, 3)


@compiled
def _factor_any(size, a, stride, pivot):
    """Factor a block of any size in place as `factor_symmetric`."""
    for k in range(size):
        pivot[k] = a[k * stride + k]
        inverse = 1.0 / pivot[k]
        for i in range(k + 1, size):
            factor = a[i * stride + k] * inverse
            for j in range(k + 1, i + 1):
                a[i * stride + j] -= factor * a[j * stride + k]
        for i in range(k + 1, size):
            a[i * stride + k] *= inverse
        a[k * stride + k] = inverse


factor_block = by_case(factor_symmetric, SIZES, _factor_any)
"""Factor a joint's block in place as L D L^T, with 1/D on the diagonal; store the pivots."""


@compiled
def _eliminate_any_rows(size, block, stride, rows, scaled, width):
    """Eliminate one vector of columns as `eliminate_rows`, for a block of any size."""
    for k in range(size):
        line = quad(rows, k * stride)
        for i in range(k + 1, size):
            at = i * stride
            set_quad(rows, at, plus_product(quad(rows, at), spread(-block[at + k]), line))
        set_quad(scaled, k * width, plus_product(spread(0.0), spread(block[k * stride + k]), line))


eliminate_block_rows = by_case(eliminate_rows, SIZES, _eliminate_any_rows)
"""Compute V = L^-1 U right of a joint's block, and D^-1 V, for one SIMD vector of columns."""


@compiled
def _eliminate_any_vector(size, block, stride, x, scaled):
    """Eliminate a joint from x as `eliminate_vector`, for a block of any size."""
    for k in range(size):
        for i in range(k + 1, size):
            x[i] -= block[i * stride + k] * x[k]
        scaled[k] = block[k * stride + k] * x[k]


eliminate_block_vector = by_case(eliminate_vector, SIZES, _eliminate_any_vector)
"""Compute x = L^-1 x of a joint, and D^-1 L^-1 x."""


@compiled
def _complete_any_vector(size, block, stride, x):
    """Compute x = L^-T x as `complete_vector`, for a block of any size."""
    for k in range(size - 1, -1, -1):
        for i in range(k):
            x[i] -= block[k * stride + i] * x[k]


complete_block_vector = by_case(complete_vector, SIZES, _complete_any_vector)
"""Compute x = L^-T x of a joint."""


@compiled
def _update_later_x(b, p, first):
    """Update x of the later joints of panel p, listed from `first` on in `right`."""
    y = shifted(b.y, p.x)
    rows = shifted(b.blocks, p.start + p.width)
    for at in range(first, p.right_end):
        x, columns = shifted(b.x, b.right[at]), shifted(rows, 4 * (at - first))
        if p.size == 2:
            take_products(1, 1, x, 0, y, 1, columns, p.stride, 2)
        elif p.size == 5:
            take_products(1, 1, x, 0, y, 1, columns, p.stride, 5)
        else:
            take_products(1, 1, x, 0, y, 1, columns, p.stride, p.size)


@compiled
def _update_later_panels(b, p, first):
    """Update the panels of the later joints of panel p, by its rows in `update` from `first` on."""
    for at in range(first, p.updates_end):
        u = panel_update(b.update, at)
        target, factors, rows = shifted(b.blocks, u.target), shifted(b.blocks, u.factors), shifted(b.blocks, u.rows)
        width, stride = p.scaled_width, p.stride
        if p.size == 5 and u.shape == 10:
            take_products(5, 2, target, u.stride, factors, width, rows, stride, 5)
        elif p.size == 2 and u.shape == 3:
            take_products(2, 1, target, u.stride, factors, width, rows, stride, 2)
        elif p.size == 3 and u.shape == 5:
            take_products(3, 1, target, u.stride, factors, width, rows, stride, 3)
        elif p.size == 6 and u.shape == 12:
            take_products(6, 2, target, u.stride, factors, width, rows, stride, 6)
        else:
            taken(u.shape, target, u.stride, factors, width, rows, stride, p.size)


@compiled
def _eliminate_joint(b, p):
    """Factor the diagonal block of panel p, and eliminate its equations from the right blocks and from x."""
    block, scaled = shifted(b.blocks, p.start), shifted(b.blocks, p.scaled)
    pivot, x, y = shifted(b.pivot, p.pivot), shifted(b.x, p.x), shifted(b.y, p.x)
    if p.size == 5 and p.scaled_width == 8:
        eliminate_node(5, 2, block, p.stride, pivot, scaled, x, y)
    elif p.size == 5 and p.scaled_width == 16:
        eliminate_node(5, 4, block, p.stride, pivot, scaled, x, y)
    else:
        factor_block(p.size, block, p.stride, pivot)
        for column in range(0, p.scaled_width, 4):
            rows = shifted(block, p.width + column)
            eliminate_block_rows(p.size, block, p.stride, rows, shifted(scaled, column), p.scaled_width)
        eliminate_block_vector(p.size, block, p.stride, x, y)


@compiled
def _eliminate(r, b):
    """Eliminate all joints from the matrix and from x; return True if all pivots are accurate."""
    r.kept = 1.0
    first_update, first_right = 0, 0
    for k in range(b.n_joints):
        p = joint_panel(b.joint, k)
        _eliminate_joint(b, p)
        for i in range(p.pivot, p.pivot + p.size):
            if not keeps_digits(r, b.pivot[i], b.pivot_scale[i]):
                return False
        _update_later_panels(b, p, first_update)
        _update_later_x(b, p, first_right)
        first_update, first_right = p.updates_end, p.right_end
    r.most_kept = max(r.most_kept, r.kept)
    return True


@compiled
def _substitute_back(b):
    """Compute x = L^-T (y - D^-1 V x) from the last joint to the first."""
    for k in range(b.n_joints - 1, -1, -1):
        p = joint_panel(b.joint, k)
        scaled, x, y = shifted(b.blocks, p.scaled), shifted(b.x, p.x), shifted(b.y, p.x)
        first = p.right_end - p.scaled_width // 4
        for i in range(p.size):
            total = spread(0.0)
            for column in range(0, p.scaled_width, 4):
                later = quad(b.x, b.right[first + column // 4])
                total = plus_product(total, quad(scaled, i * p.scaled_width + column), later)
            x[i] = y[i] - sum_of(total)
        complete_block_vector(p.size, shifted(b.blocks, p.start), p.stride, x)


@compiled
def _subtract_reactions(r, b):
    """Compute a -= j^T x."""
    subtract_reactions(r, b)
    for k in range(b.n_single):
        e = single_entry(b.single, k)
        r.a[e.velocity] -= b.j[e.j] * b.x[e.x]
    for k in range(b.n_copied):
        c = copied_block(b.copied, k)
        j, x, a = shifted(b.j, c.j), shifted(b.x, c.x), shifted(r.a, c.velocity)
        for i in range(3):
            total = spread(0.0)
            for at in range(0, c.width, 4):
                total = plus_product(total, quad(j, i * c.width + at), quad(x, at))
            a[i] -= sum_of(total)


@compiled
def factor_by_blocks(r, b, values):
    """Factor S, and eliminate x = j a - gamma with a = M^-1/2 f in r.a; return True if all pivots are accurate."""
    _assemble(r, b, values)
    for k in range(b.n_joints):
        p = joint_panel(b.joint, k)
        for i in range(p.size):
            diagonal = b.blocks[p.start + i * (p.stride + 1)]
            b.pivot_scale[p.pivot + i] = max(r.largest_scale[p.pivot + i], diagonal)
    return _eliminate(r, b)


@compiled
def accelerate_by_blocks(r, b, s, values):
    """Compute M^1/2 u' in r.a from M^-1/2 f there, and multipliers in lam; return True if successful."""
    if not factor_by_blocks(r, b, values):
        return False
    _substitute_back(b)
    _subtract_reactions(r, b)
    for k in range(s.n_c):
        s.lam[k] = b.x[b.place[k]] if b.place[k] >= 0 else 0.0
    return True


@compiled
def move_by_blocks(r, b, s, violations):
    """Compute in r.a M^1/2 times the minimum-norm change of velocities that closes violations, by the last factors."""
    _clear(b.x, b.n_x)
    for k in range(s.n_c):
        if b.place[k] >= 0:
            b.x[b.place[k]] = violations[k]
    first = 0
    for k in range(b.n_joints):
        p = joint_panel(b.joint, k)
        eliminate_block_vector(p.size, shifted(b.blocks, p.start), p.stride, shifted(b.x, p.x), shifted(b.y, p.x))
        _update_later_x(b, p, first)
        first = p.right_end
    _substitute_back(b)
    _subtract_reactions(r, b)


full_block = row_of(FullBlock)
diagonal_block = row_of(DiagonalBlock)
add_sized_rows = by_case(add_rows, {size: (size,) for size in range(MOST_ROWS, 0, -1)})


@compiled
def add_full_blocks(r, b, values):
    """Add the full blocks of J to j, to the diagonal blocks and to x."""
    for k in range(b.n_full):
        f = full_block(b.full, k)
        source = shifted(b.full_source, MOST_ROWS * k)
        block, x, j = shifted(b.blocks, f.block), shifted(b.x, f.x), shifted(b.j, f.j)
        scale, a = shifted(b.scale, f.velocity), shifted(r.a, f.velocity)
        add_sized_rows(f.size, values, source, scale, j, x, a, block, f.stride)


@compiled
def add_diagonal_blocks(r, b, values):
    """Add the diagonal blocks of J to j, to the diagonal blocks of the matrix and to x."""
    for k in range(b.n_diagonal):
        d = diagonal_block(b.diagonal, k)
        step, down = d.step, d.j_step
        block, x, j = shifted(b.blocks, d.block), shifted(b.x, d.x), shifted(b.j, d.j)
        scale, a = shifted(b.scale, d.velocity), shifted(r.a, d.velocity)
        j0, j1, j2 = values[d.source_0] * scale[0], values[d.source_1] * scale[1], values[d.source_2] * scale[2]
        x0, x1, x2 = x[0] + j0 * a[0], x[1] + j1 * a[1], x[2] + j2 * a[2]
        s0, s1, s2 = block[0] + j0 * j0, block[step] + j1 * j1, block[2 * step] + j2 * j2
        j[0], j[down], j[2 * down] = j0, j1, j2
        x[0], x[1], x[2] = x0, x1, x2
        block[0], block[step], block[2 * step] = s0, s1, s2


@compiled
def subtract_reactions(r, b):
    """Compute a -= j^T x for both kinds of blocks."""
    for k in range(b.n_full):
        f = full_block(b.full, k)
        j, x, a = shifted(b.j, f.j), shifted(b.x, f.x), shifted(r.a, f.velocity)
        if f.size > 4:
            take_rows(5, j, x, a)
        else:
            take_rows(1, j, x, a)
    for k in range(b.n_diagonal):
        d = diagonal_block(b.diagonal, k)
        down = d.j_step
        j, x, a = shifted(b.j, d.j), shifted(b.x, d.x), shifted(r.a, d.velocity)
        a0, a1, a2 = a[0] - j[0] * x[0], a[1] - j[down] * x[1], a[2] - j[2 * down] * x[2]
        a[0], a[1], a[2] = a0, a1, a2
