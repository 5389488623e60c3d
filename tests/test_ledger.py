"""The ledger gathers what the chapters measured, and the README repeats it truly."""

import json

import nbformat
import pytest
from conftest import CHAPTERS, ROOT

from labsim import ledger
from labsim.checks import CONDITIONAL, FAILS, HOLDS, Claim, ClaimsTable

CLAIMS = (Claim("it grows", "yes", "1.2 ± 0.1", HOLDS), Claim("it is | small", "< 1", "4", FAILS))


@pytest.fixture
def folder(tmp_path):
    """A folder of small chapters, each with the same two claims."""
    for _, _, chapters in ledger.PAPERS.values():
        for chapter in chapters:
            cell = nbformat.v4.new_code_cell("table", id="claims")
            cell.outputs = [nbformat.v4.new_output("display_data", ClaimsTable(*CLAIMS)._repr_mimebundle_())]
            nbformat.write(nbformat.v4.new_notebook(cells=[cell]), tmp_path / f"{chapter}_small.ipynb")
    return tmp_path


def test_claims_come_back_as_they_were_measured(folder):
    entries = ledger.read_claims(folder)
    assert [entry.claim for entry in entries] == list(CLAIMS) * 8
    assert [entry.paper for entry in entries[::2]] == [1, 1, 1, 2, 3, 3, 4, 5]


def test_totals_add_up(folder):
    entries = ledger.read_claims(folder)
    assert ledger.totals(entries) == {HOLDS: 8, CONDITIONAL: 0, FAILS: 8}
    assert ledger.totals_sentence(entries).startswith("Of 16 claims measured, 8 hold, 0 hold")
    assert [row[2] for row in ledger.totals_table(entries).rows] == ["6", "2", "4", "2", "2"]


def test_each_claim_leads_to_the_cell_that_measured_it(folder):
    text = ledger.Ledger(ledger.read_claims(folder))._repr_markdown_()
    assert "[01](01_small.ipynb#cell-id=claims)" in text
    assert "it is \\| small" in text


def test_missing_chapter_and_missing_claims_are_named(folder):
    path = folder / "04_small.ipynb"
    book = json.loads(path.read_text())
    book["cells"][0]["outputs"] = []
    path.write_text(json.dumps(book))
    with pytest.raises(ValueError, match="04_small.ipynb holds no claims"):
        ledger.read_claims(folder)
    path.unlink()
    with pytest.raises(ValueError, match="chapter 04"):
        ledger.read_claims(folder)


def test_readme_tells_the_totals_of_the_committed_chapters():
    entries = ledger.read_claims(CHAPTERS[0].parent)
    assert ledger.totals_sentence(entries) in " ".join(
        (ROOT / "README.md").read_text(encoding="utf-8").split()
    )
