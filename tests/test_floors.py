"""The house: every module imports only from lower floors, and pictures and widgets stay on theirs."""

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "labsim"
FOUNDATION = {"arguments"}
GROUND = {"motion", "noise", "metrics", "checks", "montecarlo"}
CHAINS = (
    ("vector_sensor", "surface_motion"),
    ("passive_ranging", "discriminator", "delay_tracking", "operator_display"),
    ("waveguide", "beamforming", "warping", "course"),
    ("bistatic", "gmphd"),
)
MODULES = sorted(p.relative_to(PACKAGE).with_suffix("") for p in PACKAGE.rglob("*.py") if p.name[0] != "_")


def floor(module):
    if module in FOUNDATION:
        return 0
    if module in GROUND:
        return 1
    if module.startswith(("views", "exercises")):
        return 3
    return {"lab": 4, "figures": 5}.get(module, 2)


def follows(module, other):
    """True where a chapter's chain leads from `other` to `module`."""
    return any(other in chain and module in chain[chain.index(other) + 1 :] for chain in CHAINS)


def imported(module):
    """Names of all modules that a module's file imports, anywhere in it."""
    tree = ast.parse((PACKAGE / f"{module}.py").read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        if isinstance(node, ast.ImportFrom):
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def lab_imports(module):
    """The modules of the lab that a module imports, by their names inside the package."""
    stems = {str(other).replace("\\", "/") for other in MODULES}
    names = {
        name.removeprefix("labsim.").replace(".", "/")
        for name in imported(module)
        if name.startswith("labsim.")
    }
    return names & stems


@pytest.mark.parametrize("module", [m.as_posix() for m in MODULES])
def test_module_imports_only_from_lower_floors(module):
    for other in lab_imports(module):
        allowed = floor(other) < floor(module) or follows(module, other) or other == "views/style"
        assert allowed, f"{module} imports {other}"


@pytest.mark.parametrize("module", [m.as_posix() for m in MODULES])
def test_pictures_and_widgets_stay_on_their_floors(module):
    packages = {name.split(".")[0] for name in imported(module)}
    assert "matplotlib" not in packages or floor(module) == 3
    assert not {"ipywidgets", "IPython"} & packages or module == "lab"
    assert "pyplot" not in (PACKAGE / f"{module}.py").read_text(encoding="utf-8")
