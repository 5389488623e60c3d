"""Tables as text and HTML, and the check of the installation."""

import pytest

from labsim import checks


def test_a_table_escapes_what_html_would_read():
    shown = checks.Table(("a < b",), [("1 & 2",)])._repr_html_()
    assert "a &lt; b" in shown and "1 &amp; 2" in shown


def test_a_table_with_a_row_too_short_is_refused():
    with pytest.raises(ValueError, match="rows must have 2 values"):
        checks.Table(("a", "b"), [(1, 2), (3,)])


def test_a_complete_installation_is_right_and_a_missing_package_is_named(monkeypatch):
    assert checks.check_installation().right
    monkeypatch.setattr(checks, "find_spec", lambda name: None if name == "scipy" else object())
    found = checks.check_installation()
    assert not found.right and "missing: scipy;" in found.hint and "python3 -m labsim" in found.hint
