"""Public names, each with where it is made; `__init__.py` imports one when it is first asked for."""

from warpwear.calibration.bayes.infer import infer as infer
from warpwear.calibration.bayes.result import Inference as Inference
from warpwear.contact.array.contact import ArrayContact as ArrayContact
from warpwear.contact.array.shear import ShearCertificate as ShearCertificate
from warpwear.contact.array.shear import ShearedContact as ShearedContact
from warpwear.contact.array.solve import solve_contact as solve_contact
from warpwear.contact.array.tangential import solve_tangential as solve_tangential
from warpwear.contact.certificate import Certificate as Certificate
from warpwear.contact.stress.stresses import Stresses as Stresses
from warpwear.contact.stress.stresses import stresses as stresses
from warpwear.errors import ConvergenceError as ConvergenceError
from warpwear.errors import InputError as InputError
from warpwear.errors import InvariantError as InvariantError
from warpwear.errors import StudyWarning as StudyWarning
from warpwear.history.snapshot import Snapshot as Snapshot
from warpwear.result import Result as Result
from warpwear.runs.run import run as run
from warpwear.runs.run import steps as steps
from warpwear.runs.step import RunStep as RunStep
from warpwear.study.study import Study as Study
from warpwear.sweeps.sweep import sweep as sweep
from warpwear.sweeps.table import SweepResult as SweepResult
from warpwear.version import __version__ as __version__
