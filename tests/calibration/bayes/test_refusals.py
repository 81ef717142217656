"""Wrong data, courses, unknowns and sections end in one sentence."""

from collections.abc import Callable
from pathlib import Path

import pytest
from cases_inference import smooth_study
from click.testing import CliRunner

import warpwear
from warpwear import InputError
from warpwear.cli.calibrate import bayes

pytest.importorskip("emcee")


STRENGTH = {"friction.shear_strength": "log-uniform 1 .. 20 MPa"}


@pytest.mark.parametrize(
    ("tests", "sentence"),
    [
        ([{"scar": "2.2 +- 0.1 mm"}], "test.1.scar: the scar is larger than the field of the study, 1.5 mm"),
        ([{"volume_disc": "-0.01 +- 0.001 mm^3"}], "test.1.volume_disc = .* must be greater than 0"),
        ([{"volume_disc": "0.01 mm^3"}], "the standard uncertainty is 0 of the value, .* such as '0.80"),
        ([{"volume_disc": "0.01 +- 0 mm^3"}], "the standard uncertainty is 0 of the value, and allowed"),
        (
            [{"volume_disc": "0.01 +- 0.001 mm"}],
            "volume_disc = '0.01 \\+- 0.001 mm': has the wrong dimension",
        ),
        ([{"friction": "60 +- 1"}], "as if in percent"),
        ([{"friction": "0.6 +- 0.01 at 9000 mm"}], "the study slides 2400 mm"),
        ([{"friction": "0.6 +- 0.01 mm"}], "no unit is expected"),
        ([{"volume_disc": "0.01 +- 1e-20 mm^3"}] * 2, "the standard uncertainty is 1e-18 of the value"),
        ([{"volume_disc": "0.01 +- 1e-300 mm^3"}], "is beyond what can be computed with"),
        ([{"volume_disc": "0.01 +- 1e20 mm^3"}], "the standard uncertainty is 1e\\+22 of the value"),
        ([{"volume_disc": "1e-300 +- 1e-301 mm^3"}], "is beyond what can be computed with"),
        ([{"weight": "3 +- 1 mm"}], "'test.1.weight' is no key"),
        (
            [{"volume": "0.01 +- 0.001 mm^3"}],
            "of a body that is not known: give volume_counter or volume_disc",
        ),
        ([{"load": "16 N", "scar": "1.2 +- 0.1 mm"}], "test.1.load is 16, and the study has 8: they have to"),
        ([{"load": "8 +- 1 N", "scar": "1.2 +- 0.1 mm"}], "test.1.load has an uncertainty"),
        ([{}], "nothing was measured"),
    ],
)
def test_wrong_data_end_in_one_sentence(tests: list[dict[str, str]], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        warpwear.infer(smooth_study(), unknown=STRENGTH, tests=tests)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "Distance [mm],CoF\n" + "".join(f"{100 * n},{20 + n}\n" for n in range(1, 20)),
            "as if in percent: 20 instead of 0.20",
        ),
        (
            "Distance [mm],CoF,Normal force [N]\n" + "".join(f"{100 * n},0.3,4.1\n" for n in range(1, 20)),
            "the normal force is 4.1 N",
        ),
        (
            "Distance [mm],CoF\n" + "".join(f"{100 * n},0.0\n" for n in range(1, 20)),
            "the coefficient of friction is 0 in the middle: nothing was measured",
        ),
        (
            "Distance [mm],Temperature [C]\n" + "".join(f"{100 * n},20\n" for n in range(1, 20)),
            "no column for the coefficient",
        ),
        (
            "Distance [mm],CoF\n" + "".join(f"{5000 + n},0.3\n" for n in range(1, 20)),
            "has 0 points from 0 to 2400 mm",
        ),
    ],
)
def test_a_wrong_course_ends_in_one_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    path = tmp_path / "test.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=sentence):
        warpwear.infer(smooth_study(), unknown=STRENGTH, tests=[{"record": path}])


@pytest.mark.parametrize(
    ("unknown", "sentence"),
    [
        ({}, "no unknown is named"),
        ({"wear.spere": None}, "wear.spere"),
        ({"contact.law": None}, "it is no number"),
        ({"wear.counter": "normal 1 +- 0.1 mm"}, "has the unit mm"),
        ({"wear.counter": "normal 1 +- 0.1"}, "needs its unit"),
        ({"wear.counter": "between 1 and 2"}, "the prior of 'wear.counter' = 'between 1 and 2'"),
        ({"wear.counter": "uniform -1e-4 .. 1e-3 mm^3/N/m"}, "goes beyond what is allowed: from 0"),
        ({"friction.initial_ratio": "uniform 0.1 .. 1"}, "needs friction.running_in"),
        (
            {"wear.decay": "uniform 0.1 .. 1 1/m"},
            "wear.decay .* does not apply to wear.law = 'archard'; allowed",
        ),
        ({"friction.coefficient": "uniform 0.1 .. 1"}, "friction.coefficient .* is measured, .* allowed is"),
        ({"friction.film.shear_strength": "uniform 1 .. 9 MPa"}, "friction.film.thickness is missing"),
        ({"wear.dust_fraction": "uniform 0 .. 1"}, "wear.dust_fraction .* does not apply without a wear.par"),
    ],
)
def test_wrong_unknowns_end_in_one_sentence(unknown: dict[str, str | None], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        warpwear.infer(smooth_study(), unknown=unknown, tests=[{"volume_counter": "0.018 +- 0.001 mm^3"}])


@pytest.mark.parametrize(
    ("section", "sentence"),
    [
        ("infer = 3", "infer = 3 is not a section; write [infer]"),
        ("[infer]\nunknown = 'x'", "infer.unknown = 'x' is not a section; write [infer.unknown]"),
        ("[infer]\nunknwon = {}", "'infer.unknwon' is no key of a study; did you mean 'infer.unknown'?"),
        ("[infer]\nnext = 'a'", "infer.next = 'a': must be a list in brackets, such as ['test-1.csv']"),
        (
            "[test]\nscar = '0.8 +- 0.02 mm'",
            "is no list of tests; write [[test]] and the keys of one below it",
        ),
        ("[[test]]\nrecord = 3", "test.1.record = 3: must be text in quotes"),
        ("[infer]\ntarget = 3", "infer.target = 3: must be text in quotes"),
        ("[[test]]\nscar = 0.8", "test.1.scar = 0.8: needs its unit: a length such as '1.5 mm'"),
        ("[infer.unknown]\nwear.counter = 3", "infer.unknown.wear.counter = 3: must be text in quotes"),
    ],
)
def test_a_wrong_section_is_one_sentence(tmp_path: Path, section: str, sentence: str) -> None:
    study = smooth_study().to_toml()
    path = tmp_path / "study.toml"
    path.write_text(f"{section}\n{study}" if section.startswith("infer") else f"{study}\n{section}\n")
    assert sentence in refused(path)


def refused(study: Path | str, *more: str) -> str:
    """The sentence that the command ends in."""
    done = CliRunner().invoke(bayes, [str(study), *more])
    assert isinstance(done.exception, InputError), done.output
    assert "\n" not in str(done.exception)
    return str(done.exception)


def test_wrong_data_end_the_command_in_one_sentence(tmp_path: Path) -> None:
    """A course in percent, a load that is off, a scar larger than the field."""
    given = ("v1", "--set", "stepping.scheme=implicit", "--unknown")
    given = (*given, "friction.shear_strength=log-uniform 1 .. 20 MPa")
    percent, heavy = tmp_path / "percent.csv", tmp_path / "heavy.csv"
    percent.write_text("Distance [mm],CoF\n" + "".join(f"{100 * n},{20 + n}\n" for n in range(1, 20)))
    heavy.write_text("Distance [mm],CoF,Fn [N]\n" + "".join(f"{100 * n},0.3,10\n" for n in range(1, 20)))
    assert "as if in percent: 20 instead of 0.20" in refused(*given, "--experiment", str(percent))
    percent.write_text(percent.read_text().replace("CoF", "CoF [%]"))
    assert "'CoF [%]' has the unit %, where a plain number" in refused(*given, "--experiment", str(percent))
    assert "the normal force is 10 N in the middle, the study has contact.load = 8 N" in refused(
        *given, "--experiment", str(heavy)
    )
    assert "the scar is larger than the field of the study, 1.5 mm" in refused(
        *given, "--scar", "1.8 +- 0.02 mm"
    )


def test_priors_beyond_the_explicit_limit_are_refused_before_any_run(
    failing: Callable[[str, Exception], None],
) -> None:
    """The limit goes with the wear coefficients, so that the prior says it."""
    failing("warpwear.calibration.bayes.runs.make_all", AssertionError("a run was made"))
    priors = {"wear.counter": "log-uniform 1e-4 .. 5e-2 mm^3/N/m"}
    with pytest.raises(InputError, match=r"of 16 runs .* explicit .*None was made; .*scheme = 'implicit'"):
        warpwear.infer("v1", unknown=priors, tests=[{"scar": "1.3 +- 0.1 mm"}])
