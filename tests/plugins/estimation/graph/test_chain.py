"""The chain against GTSAM's own elimination, and its reuse of earlier results."""

import gtsam
import numpy as np
import pytest
from executive_plugins.estimation.factors import keys
from executive_plugins.estimation.graph.chain import GraphChain, node_of, nodes_of


def tie(first: int, second: int, rng: np.random.Generator) -> gtsam.JacobianFactor:
    """Return a linear factor between two whole nodes."""
    (x0, v0, b0), (x1, v1, b1) = keys(first), keys(second)
    sizes = {x0: 6, v0: 3, b0: 6, x1: 6, v1: 3, b1: 6}
    graph = gtsam.GaussianFactorGraph()
    unit = gtsam.noiseModel.Unit.Create(15)
    for key, size in sizes.items():
        graph.push_back(
            gtsam.JacobianFactor(key, rng.normal(0, 1, (15, size)), rng.normal(0, 1, 15), unit)
        )
    return gtsam.JacobianFactor(graph)


@pytest.fixture
def factors() -> list[gtsam.JacobianFactor]:
    """Six nodes in a row; some are tied over one between."""
    rng = np.random.default_rng(0)
    return [tie(a, b, rng) for a, b in ((0, 1), (1, 2), (0, 2), (2, 3), (3, 4), (2, 4), (4, 5))]


def solved(chain: GraphChain) -> gtsam.VectorValues:
    solution = gtsam.VectorValues()
    for done in chain.backwards():
        solution.insert(done.conditional.solve(solution))
    return solution


def reference(factors) -> gtsam.VectorValues:
    graph = gtsam.GaussianFactorGraph()
    for factor in factors:
        graph.push_back(factor)
    return graph.optimize()


def test_the_solution_is_that_of_gtsam(factors) -> None:
    chain = GraphChain()
    chain.eliminate(range(6), factors)
    np.testing.assert_allclose(solved(chain).vector(), reference(factors).vector(), atol=1e-9)


def test_new_factors_at_the_end_leave_the_elimination_of_the_beginning(factors) -> None:
    chain = GraphChain()
    chain.eliminate(range(6), factors)
    old = [done.conditional for done in chain.backwards()][:1:-1]
    chain.void_from(4)
    assert chain.separator() == {4}
    extra = tie(4, 5, np.random.default_rng(9))
    chain.eliminate(range(6), [f for f in [*factors, extra] if min(nodes_of(f)) >= 4])
    assert [done.conditional for done in chain.backwards()][:1:-1] == old
    np.testing.assert_allclose(
        solved(chain).vector(), reference([*factors, extra]).vector(), atol=1e-9
    )


def test_dropped_nodes_leave_their_marginal(factors) -> None:
    chain = GraphChain()
    chain.eliminate(range(6), factors)
    rests = chain.drop(3)
    assert {node for rest in rests for node in nodes_of(rest)} == {3, 4}
    kept = [*rests, *(f for f in factors if min(nodes_of(f)) >= 3)]
    whole = reference(factors)
    marginal = reference(kept)
    for key in (key for node in (3, 4, 5) for key in keys(node)):
        np.testing.assert_allclose(marginal.at(key), whole.at(key), atol=1e-9)


def test_a_copy_is_independent(factors) -> None:
    chain = GraphChain()
    chain.eliminate(range(6), factors)
    twin = chain.copy()
    twin.void_from(0)
    assert (len(chain), len(twin)) == (6, 0)


def test_a_key_gives_its_node() -> None:
    assert {node_of(key) for key in keys(1234)} == {1234}
