# SPDX-License-Identifier: BSD-3-Clause
"""Clearance as a function of torch: its gradients are finite differences, and what has none is refused."""

import numpy as np
import pytest
from conftest import random_robot, rigid

import clearance

torch = pytest.importorskip("torch", reason="needs torch")
least_distances = pytest.importorskip("clearance.torch").least_distances

Q = np.array([[0.2, 0.1, -0.3], [0.6, -0.4, 0.2], [-0.5, 0.3, 0.0], [0.1, 0.9, 1.0], [-0.8, -0.2, 0.4], [0.0, 1.2, -0.7]])


@pytest.fixture
def ask(arm):
    return clearance.Query(arm, clearance.MinDistances())


@pytest.fixture
def cloud(rng):
    """Points around the arm, none in it."""
    way = rng.normal(size=(400, 3))
    return (way / np.linalg.norm(way, axis=1, keepdims=True) * rng.uniform(1.3, 2, (400, 1))).astype("f4")


def weighed(of, weights=1.0):
    """A sum of distances, and of which pairs they are."""
    return float((of["distance"].astype("f8") * weights).sum()), [of[name].tolist() for name in ("point", "part", "primitive")]


def assert_is_gradient(given, f, x, step=1e-3):
    """Whether f changes so with each entry of x, by central differences; where another pair becomes the nearest is a kink."""
    checked = 0
    for i in np.ndindex(x.shape):
        there, back = x.copy(), x.copy()
        there[i] += step
        back[i] -= step
        (more, one), (less, other) = f(there), f(back)
        if one == other:
            checked += 1
            assert abs(given[i] - (more - less) / (2 * step)) < 2e-3, i
    assert checked > 0.6 * x.size
    assert np.abs(given).max() > 0.1


def test_the_values_are_the_querys(ask, cloud):
    q = torch.tensor(Q, requires_grad=True)
    d = least_distances(ask, q, points=cloud)
    assert d.dtype == torch.float64 and d.requires_grad
    assert (d.detach().numpy() == ask(cloud, joints=Q).of["distance"]).all()


@pytest.mark.parametrize("shape", [(6,), (2, 3), (3, 2, 1)])
def test_the_gradient_by_joints_is_that_of_differences_in_any_batch(ask, cloud, shape):
    weights = np.linspace(1, 2, 6)
    q = torch.tensor(Q.reshape(*shape, 3), requires_grad=True)
    d = least_distances(ask, q, points=cloud)
    assert d.shape == shape
    (d * torch.tensor(weights.reshape(shape))).sum().backward()
    assert q.grad.shape == (*shape, 3)
    assert_is_gradient(q.grad.numpy().reshape(6, 3), lambda x: weighed(ask(cloud, joints=x).of, weights), Q)


@pytest.mark.parametrize("shape", [(), (6,), (2, 3)])
def test_each_part_has_a_distance_and_a_gradient(arm, cloud, shape):
    ask = clearance.Query(arm, clearance.MinDistancesPerPart())
    given = Q.reshape(*shape, 3) if shape else Q[0]
    parts = len(arm)
    weights = np.linspace(1, 2, given.size // 3 * parts)
    q, points = torch.tensor(given, requires_grad=True), torch.tensor(cloud, requires_grad=True)
    d = least_distances(ask, q, points=points)
    assert d.shape == (*shape, parts)
    assert (d.detach().numpy().ravel() == ask(cloud, joints=given).all["distance"]).all()
    (d * torch.tensor(weights.reshape(d.shape))).sum().backward()
    assert_is_gradient(q.grad.numpy(), lambda x: weighed(ask(cloud, joints=x).all, weights), given)
    near = np.unique(ask(cloud, joints=given).all["point"])
    assert (np.delete(points.grad.numpy(), near, 0) == 0).all()

    def total(x):
        moved = cloud.copy()
        moved[near] = x
        return weighed(ask(moved, joints=given).all, weights)
    assert_is_gradient(points.grad.numpy()[near], total, cloud[near].astype("f8"))


def test_one_configuration_has_a_distance_without_axes(ask, cloud):
    q = torch.tensor(Q[0], requires_grad=True)
    d = least_distances(ask, q, cloud)
    assert d.shape == ()
    d.backward()
    assert q.grad.shape == (3,) and (q.grad != 0).any()


@pytest.mark.parametrize("kind", [torch.float32, torch.float64])
@pytest.mark.parametrize("placed", [False, True])
def test_the_gradient_by_points_is_that_of_differences(ask, cloud, rng, kind, placed):
    given = {"cloud_pose": rigid(rng, 0.2)} if placed else {}
    points = torch.tensor(cloud, dtype=kind, requires_grad=True)
    q = torch.tensor(Q[:3], requires_grad=True)
    weights = np.array([1.0, 2.0, 3.0])
    (least_distances(ask, q, points=points, **given) * torch.tensor(weights)).sum().backward()
    assert points.grad.dtype == kind and points.grad.shape == points.shape
    near = np.unique(ask(cloud, joints=Q[:3], **given).of["point"])
    others = np.delete(np.arange(len(cloud)), near)
    assert (points.grad.numpy()[others] == 0).all()

    def total(x):
        moved = cloud.copy()
        moved[near] = x
        return weighed(ask(moved, joints=Q[:3], **given).of, weights)
    assert_is_gradient(points.grad.numpy()[near], total, cloud[near].astype("f8"))


def test_points_alone_have_a_gradient_and_images_of_points_keep_their_shape(ask, cloud):
    points = torch.tensor(cloud.reshape(20, 20, 3), requires_grad=True)
    least_distances(ask, torch.tensor(Q), points=points).sum().backward()
    assert points.grad.shape == (20, 20, 3) and (points.grad != 0).any()


def test_points_that_are_nearest_to_several_configurations_add_up(ask):
    points = torch.tensor([[2.0, 0.0, 0.5]], requires_grad=True)
    least_distances(ask, torch.zeros(4, 3), points=points).sum().backward()
    assert abs(float(points.grad.norm()) - 4) < 1e-5


def test_a_distance_without_a_gradient_does_not_move(arm, cloud):
    ask = clearance.Query(arm, clearance.MinDistances(0.1))  # nothing is as near
    q, points = torch.tensor(Q, requires_grad=True), torch.tensor(cloud, requires_grad=True)
    d = least_distances(ask, q, points=points)
    assert torch.isinf(d).all()
    d.sum().backward()
    assert (q.grad == 0).all() and (points.grad == 0).all()
    inside = torch.tensor([[0.0, 0.0, 0.1]], requires_grad=True)
    q.grad = None
    d = least_distances(ask, q, points=inside)
    assert (d == 0).all()
    d.sum().backward()
    assert (q.grad == 0).all() and (inside.grad == 0).all()


def test_what_changes_before_backward_changes_no_gradient(ask, cloud):
    q = torch.tensor(Q, requires_grad=True)
    least_distances(ask, q, points=cloud).sum().backward()
    expected, leaf = q.grad.clone(), torch.tensor(Q, requires_grad=True)
    moved = leaf * 1
    d = least_distances(ask, moved, points=cloud)
    with torch.no_grad():
        moved.zero_()
    d.sum().backward()
    assert (leaf.grad == expected).all()


def test_base_and_ignored_limits_are_of_the_gradient_too(ask, cloud):
    base = np.eye(4)
    base[:3, 3] = 0.1, -0.2, 0.05
    beyond = Q.copy()
    beyond[:, 0] = 2.3  # the shoulder ends at 2
    given = {"base": base, "ignore_limits": True}
    q = torch.tensor(beyond, requires_grad=True)
    least_distances(ask, q, points=cloud, **given).sum().backward()
    assert_is_gradient(q.grad.numpy(), lambda x: weighed(ask(cloud, joints=x, **given).of), beyond)


def test_descent_gets_away(ask):
    wall = np.stack(np.meshgrid([0.5], np.linspace(-1, 1, 41), np.linspace(0, 1.5, 41)), -1).reshape(-1, 3).astype("f4")
    q = torch.tensor([[0.3, 0.2, 0.1]], requires_grad=True)
    optimizer = torch.optim.SGD([q], lr=0.1)
    first = None
    for _ in range(20):
        optimizer.zero_grad()
        d = least_distances(ask, q, points=wall).sum()
        first = float(d) if first is None else first
        (-d).backward()
        optimizer.step()
    assert float(least_distances(ask, q, points=wall).sum()) > first + 0.05


def test_joints_of_integers_are_refused(ask, cloud):
    with pytest.raises(TypeError, match=r"joints is a floating tensor.*int64"):
        least_distances(ask, torch.zeros(2, 3, dtype=torch.int64), points=cloud)
    with pytest.raises(TypeError, match="joints is a tensor of torch, not ndarray"):
        least_distances(ask, Q, points=cloud)


@pytest.mark.parametrize("by", ["joints", "points"])
def test_a_second_derivative_is_refused_and_not_zero(ask, cloud, by):
    q, points = torch.tensor(Q, requires_grad=True), torch.tensor(cloud, requires_grad=True)
    d = least_distances(ask, q, points=points).sum()
    slope, = torch.autograd.grad(d, q if by == "joints" else points, create_graph=True)
    with pytest.raises(RuntimeError, match="second derivative of distances is not known"):
        (slope.pow(2).sum() + q.pow(2).sum()).backward()


def test_what_the_distances_go_into_has_a_second_derivative(ask, cloud):
    q, scale = torch.tensor(Q, requires_grad=True), torch.tensor(2.0, dtype=torch.float64, requires_grad=True)
    slope, = torch.autograd.grad((least_distances(ask, q, points=cloud) * scale).sum(), q, create_graph=True)
    again, = torch.autograd.grad(slope.sum(), scale)
    assert abs(float(again) - float(slope.detach().sum()) / 2) < 1e-9


@pytest.mark.parametrize("name", ["base", "cloud_pose"])
def test_another_argument_that_requires_a_gradient_is_refused(ask, cloud, name):
    pose = torch.eye(4, dtype=torch.float64, requires_grad=True)
    with pytest.raises(TypeError, match=rf"{name} requires a gradient.*{name}\.detach"):
        least_distances(ask, torch.tensor(Q), points=cloud, **{name: pose})


def test_clouds_that_require_a_gradient_are_refused(ask, cloud):
    with pytest.raises(TypeError, match="clouds requires a gradient"):
        least_distances(ask, torch.tensor(Q), clouds=[torch.tensor(cloud, requires_grad=True)])


def test_another_question_and_a_robot_without_joints_are_refused(arm, cloud, rng):
    with pytest.raises(TypeError, match="Query of MinDistances"):
        least_distances(clearance.Query(arm, clearance.MinDistance()), torch.tensor(Q), points=cloud)
    robot, _, _ = random_robot(rng)
    with pytest.raises(ValueError, match="no joints"):
        least_distances(clearance.Query(robot, clearance.MinDistances()), torch.tensor(Q), points=cloud)
