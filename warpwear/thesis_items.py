"""Every item of the report of the thesis, in its order."""

from warpwear.thesis_findings import FINDINGS
from warpwear.thesis_items_appendix import TABLE as APPENDIX
from warpwear.thesis_items_compared import TABLE as COMPARED
from warpwear.thesis_items_v1 import TABLE as V1
from warpwear.thesis_items_v2 import TABLE as V2
from warpwear.thesis_items_v3 import TABLE as V3
from warpwear.thesis_verdicts import Item

#: Figures and tables of the thesis.
OF_THESIS: tuple[Item, ...] = tuple(
    entry for table in (V1, V2, V3, COMPARED, APPENDIX) for entry in table.items
)
#: Those, then statements of our own.
ALL_ITEMS: tuple[Item, ...] = (*OF_THESIS, *FINDINGS.items)
