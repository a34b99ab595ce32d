"""The audit trail."""

from typing import Annotated

from fastapi import APIRouter, Depends, Query
from pydantic import AwareDatetime

from api import schemas
from api.dependencies import BeforeNumber, CurrentContext, Limit, Requires
from api.services import auditing, paging
from api.services.access import Role
from storage import audit

router = APIRouter(prefix="/audit", tags=["audit"], dependencies=[Depends(Requires(Role.ADMIN))])


@router.get("")
def list_audit(
    context: CurrentContext,
    before: BeforeNumber,
    actor: Annotated[schemas.Words | None, Query(description="Name of the key it was done with.")] = None,
    action: Annotated[schemas.Words | None, Query(description="Such as `device.edit`.")] = None,
    target: Annotated[schemas.Words | None, Query(description="Such as `devices/van-7`.")] = None,
    since: Annotated[AwareDatetime | None, Query(description="Done at or after.")] = None,
    until: Annotated[AwareDatetime | None, Query(description="Done before.")] = None,
    limit: Limit = 100,
) -> schemas.Page[schemas.AuditEntry]:
    """List who did what, newest first. Uploads are not in it."""
    with context.database.read() as tx:
        rows = audit.page(tx, limit + 1, before, audit.Filter(actor, action, target, since, until))
    return paging.page(rows, limit, lambda row: row.pk, auditing.present)
