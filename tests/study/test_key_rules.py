"""Conditions and demands of keys that are numbers, or yes or no."""

from warpwear import Study
from warpwear.study.keys import excludes, when

STUDY = Study.load("v3-fine").replace({"wear.particle": "60 um", "wear.particle_thickness": "1 um"})


def test_a_condition_without_values_holds_where_something_is_true() -> None:
    (rule,) = when("wear.dust_fraction")
    assert rule.why_not(STUDY) == "does not apply to wear.dust_fraction = '0.0'"
    assert rule.why_not(STUDY.replace({"wear.dust_fraction": 0.3})) is None


def test_a_yes_that_does_not_go_with_something_is_refused_in_a_sentence() -> None:
    (demand,) = excludes("study.model", "micro", of=True)
    said = "checks.strict = true does not go with study.model = 'micro'; allowed is false"
    assert demand.refusal(STUDY.replace({"checks.strict": True}), "checks.strict") == said
    (demand,) = excludes("checks.strict", True)
    said = "study.model = 'micro' does not go with checks.strict = true; allowed is checks.strict = false"
    assert demand.refusal(STUDY.replace({"study.model": "micro"}), "study.model") == said
