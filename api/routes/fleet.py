"""The fleet at a glance."""

from fastapi import APIRouter

from api import schemas
from api.dependencies import Caller, CurrentContext
from api.services import fleet

router = APIRouter(prefix="/fleet", tags=["fleet"])


@router.get("/summary")
def read_summary(principal: Caller, context: CurrentContext) -> schemas.FleetSummary:
    """Count devices by stage and open alerts by kind and severity; a device counts itself alone."""
    return fleet.summary(context, principal)
