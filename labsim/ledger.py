"""The claims of the five papers, gathered from the chapters that measured them.

Each chapter saves its table of claims as data with the notebook. The ledger reads what was measured
there, computes nothing anew and types nothing in.
"""

import json
from dataclasses import dataclass
from pathlib import Path

from labsim.checks import VERDICTS, Claim, ClaimsTable, Table

PAPERS = {
    1: ("one vector sensor and a passing vessel", "Wu & Hu 2010", ("01", "02", "03")),
    2: ("course from bearings and a range ratio", "Dong et al. 2020", ("06",)),
    3: ("passive ranging with three hydrophones", "NDRE, in translation", ("04", "05")),
    4: ("pairing bearings through a gate", "Xu et al. 2022", ("07",)),
    5: ("bistatic tracking with a GM-PHD filter", "Ma et al. 2023", ("08",)),
}


@dataclass(frozen=True)
class Entry:
    """A claim and where it was measured: the paper's number, the notebook's file name, the cell's id."""

    paper: int
    notebook: str
    cell: str
    claim: Claim


def read_claims(folder):
    """Every claim saved in the chapters of a folder of notebooks, in the order of papers and chapters.

    Raises ValueError where a chapter of a paper is missing or holds no claims.
    """
    entries = []
    for paper, (_, _, chapters) in PAPERS.items():
        for chapter in chapters:
            entries += _claims_of(paper, chapter, Path(folder))
    return entries


def totals(entries):
    """How many claims got each verdict, a dict in the order of the verdicts."""
    return {verdict: sum(entry.claim.verdict == verdict for entry in entries) for verdict in VERDICTS}


def totals_sentence(entries):
    """The totals in words."""
    count = totals(entries)
    return (
        f"Of {len(entries)} claims measured, {count['holds']} hold, {count['holds with conditions']} hold "
        f"with conditions, and {count['does not hold']} do not hold."
    )


def totals_table(entries):
    """The totals by paper."""
    rows = []
    for paper, (subject, name, _) in PAPERS.items():
        count = totals([entry for entry in entries if entry.paper == paper])
        rows.append((f"{paper}. {name}", subject, sum(count.values()), *count.values()))
    return Table(("paper", "subject", "claims", *VERDICTS), rows)


class Ledger:
    """The claims of a list of entries as a table, each with a link to the cell that measured it."""

    def __init__(self, entries):
        self.entries = entries

    def __repr__(self):
        return "\n".join(f"{e.claim.statement} | {e.claim.verdict} | {e.notebook[:2]}" for e in self.entries)

    def _repr_markdown_(self):
        lines = [
            "| the paper says | its value | we measure | verdict | measured in |",
            "|:--|:--|:--|:--|:--|",
        ]
        for entry in self.entries:
            claim, link = entry.claim, f"[{entry.notebook[:2]}]({entry.notebook}#cell-id={entry.cell})"
            texts = [text.replace("|", "\\|") for text in (claim.statement, claim.paper, claim.measured)]
            lines.append(f"| {' | '.join(texts)} | **{claim.verdict}** | {link} |")
        return "\n".join(lines)


def _claims_of(paper, chapter, folder):
    paths = sorted(folder.glob(f"{chapter}_*.ipynb"))
    if not paths:
        raise ValueError(f"folder must hold the notebook of chapter {chapter}, but {folder} does not")
    cells = json.loads(paths[0].read_text(encoding="utf-8"))["cells"]
    entries = [
        Entry(paper, paths[0].name, cell["id"], Claim(**claim))
        for cell in cells
        for output in cell.get("outputs", [])
        for claim in output.get("data", {}).get(ClaimsTable.MIME, [])
    ]
    if not entries:
        raise ValueError(f"{paths[0].name} holds no claims; run it from top to bottom and save it")
    return entries
