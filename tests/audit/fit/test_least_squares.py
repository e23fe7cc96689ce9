"""Weighted least squares, against systems solved by hand and published tables of quantiles."""

from math import inf, isclose, sqrt

import pytest

from elitescript.audit.fit.least_squares import chi_square_quantile, solve, student_quantile


def test_a_line_through_four_points_by_hand():
    # y = 1 + 2 x with errors +1, -1, -1, +1 at x = 0, 1, 2, 3: the line is y = 1 + 2 x, chi square 4.
    solution = solve([[1.0, 0.0], [1.0, 1.0], [1.0, 2.0], [1.0, 3.0]], [2.0, 2.0, 4.0, 8.0])
    assert solution.values == pytest.approx((1.0, 2.0))
    assert solution.chi_square == pytest.approx(4.0)
    assert solution.freedom == 2
    # (X^T X)^-1 = [[14, -6], [-6, 4]] / 20.
    assert solution.sigma_of(0) == pytest.approx(sqrt(14 / 20))
    assert solution.sigma_of(1) == pytest.approx(sqrt(4 / 20))
    assert solution.sigma([1.0, 1.0]) == pytest.approx(sqrt((14 + 4 - 12) / 20))


def test_what_the_equations_do_not_see_has_no_sigma_and_stays_at_zero():
    # Only x - y is seen.
    solution = solve([[1.0, -1.0, 0.0], [2.0, -2.0, 0.0], [0.0, 0.0, 1.0]], [3.0, 6.0, 5.0])
    assert solution.sigma_of(0) == inf
    assert solution.sigma_of(2) == pytest.approx(1.0)
    assert solution.sigma([1.0, -1.0, 0.0]) == pytest.approx(1.0 / sqrt(5.0))
    assert solution.values == pytest.approx((1.5, -1.5, 5.0))
    (vague,) = [row for row in solution.directions if row.sigma == inf]
    assert [abs(share) for share in vague.vector] == pytest.approx([sqrt(0.5), sqrt(0.5), 0.0])


def test_fewer_equations_than_unknowns():
    solution = solve([[0.0, 2.0, 0.0]], [4.0])
    assert solution.values == pytest.approx((0.0, 2.0, 0.0))
    assert solution.freedom == 0
    assert solution.sigma_of(1) == pytest.approx(0.5)
    assert solution.sigma_of(0) == inf


def test_a_badly_conditioned_system_keeps_its_digits():
    # Condition 1e7; the normal equations would lose all digits of the second unknown.
    small = 1e-7
    solution = solve([[1.0, 1.0], [1.0, 1.0 + small], [1.0, 1.0 - small]], [3.0, 3.0 + 2 * small, 3.0 - 2 * small])
    assert solution.values == pytest.approx((1.0, 2.0), rel=1e-6)


@pytest.mark.parametrize(
    ("freedom", "printed"), [(1, 12.706), (2, 4.303), (3, 3.182), (5, 2.571), (10, 2.228), (30, 2.042), (1000, 1.962)]
)
def test_student_quantiles_of_the_tables(freedom, printed):
    assert isclose(student_quantile(freedom), printed, abs_tol=6e-4)


@pytest.mark.parametrize(("freedom", "printed"), [(3, 11.345), (6, 16.812), (12, 26.217), (100, 135.807)])
def test_chi_square_quantiles_of_the_tables(freedom, printed):
    assert chi_square_quantile(freedom, 0.99) == pytest.approx(printed, rel=0.01)
