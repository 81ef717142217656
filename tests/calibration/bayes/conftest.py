"""What several test files of inference start from."""

import numpy as np
import pytest
from cases_inference import drawn, smooth_study

from warpwear.calibration.bayes.data import Data, MeasuredValue


@pytest.fixture(scope="module")
def linear() -> Data:
    """Coefficients of friction at single distances: a linear problem with normal priors and known errors."""
    study = smooth_study()
    points = tuple(
        MeasuredValue("friction", 0.5, 0.02, at) for at in np.linspace(100.0, study.sliding.total, 12)
    )
    return drawn(study, {"friction.ploughing": 0.21, "friction.shear_strength": 3.1}, Data(points=points), 3)
