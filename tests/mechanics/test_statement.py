"""What a statement refuses, and how."""

from __future__ import annotations

import pytest

from curvebound.mechanics import Mechanics, length, mass, parameter


def test_no_name_stands_for_two_things() -> None:
    x = length("cart.x")
    with pytest.raises(ValueError, match=r"cart\.x would stand for two things.*cart\.u"):
        Mechanics([x], [mass("cart", x, 0)])
    u = length("cart.u")
    with pytest.raises(ValueError, match=r"cart\.x would"):
        Mechanics([u], [mass("cart", u, 0), mass("cart", u, 1)])
    with pytest.raises(ValueError, match=r"rail\.y would"):
        Mechanics([u], [mass("cart", u, parameter("rail.y"))], frame="rail")
    with pytest.raises(ValueError, match=r"field\.x would"):
        Mechanics([field := length("field.x")], [mass("cart", field, 0)])
    assert "cart.u" in Mechanics([u], [mass("cart", u, parameter("cart.rise"))]).outputs
