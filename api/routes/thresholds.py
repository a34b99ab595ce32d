"""What the service decides by."""

from fastapi import APIRouter, Depends

from api import schemas
from api.dependencies import CurrentContext, Requires
from api.services import thresholds
from api.services.access import Role

router = APIRouter(prefix="/thresholds", tags=["fleet"], dependencies=[Depends(Requires(Role.MANAGER))])


@router.get("")
def list_thresholds(context: CurrentContext) -> schemas.Thresholds:
    """List what the service decides by; it is set where the service is started."""
    return thresholds.listed(context)
