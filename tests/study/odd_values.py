"""What the tests with broken studies put in the place of values."""

from hypothesis import strategies as st

WORDS = """inf mm|-inf N|nan MPa|1e400 mm|0 mm|-1 um|8 N|3 GPa|1 mm^3/N/m|1/m|1e-300 mm|1e300 N|5 µm|10 Å
|2 min|inf s|1 Hz|60 rpm|90 deg|200 HV10|60 HRC|0,55|1e-4 mm3/Nm|auto
|one cell|area|macro|micro|self-affine|milled|flat|explicit|implicit|radial|updated"""
NUMBERS = "1_0|0x10|1e|.5.|½|٣|--1|1e-30|1e30"
UNITS = """mm|um|m|km|N|Nm|mm³/N·m|mm2|turn/s|rad|HV|HB|HRC|/|/N·m
|MPa|Pa^-1|mm^2/N|mm^3/N/m|degC|dB|mol|()|^9|mm/min|J/m^2|deg|parsec|m**9999999|(((m
|__import__('os')|1|%|‰"""
#: What is little once and too much when it is repeated.
LONG = ["a.", "9", " ", "m*", "(", "[", '"', "8 N ", "mm/", "\n", "HV "]


def one_of(words: str) -> st.SearchStrategy[str]:
    """Of words between bars."""
    return st.sampled_from([word.strip("\n") for word in words.split("|")])


#: What numbers with units, and what is none, may look like in a study.
VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=12),
    one_of(WORDS),
    st.builds(
        "{}{}{}".format,
        st.one_of(st.floats(), st.integers(), one_of(NUMBERS)),
        st.sampled_from(["", " ", "  ", "\t", "\n", "*", "/", " 1/"]),
        one_of(UNITS),
    ),
    st.builds(lambda piece, times: piece * times, st.sampled_from(LONG), st.integers(1, 60_000)),
    st.lists(st.one_of(st.integers(), one_of("1 mm|3 N|-2 mm|nan mm")), max_size=4),
    st.dictionaries(one_of("kind|a|load|"), st.sampled_from(["flat", "1 mm", 3]), max_size=2),
)
