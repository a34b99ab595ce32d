"""The audit trail: who did what to what, written in the transaction of what it tells, so that it is neither lost nor
untrue. Uploads are not in it: their receipts are kept anyway. No secret is ever given to it.

Actions are `resource.verb`; a target is the path of what was changed below `/api/v1/`.
"""

from datetime import datetime
from typing import Any

from api import schemas
from api.logs import REQUEST_ID
from api.services import plain
from api.services.access import Principal, Role
from storage import audit
from storage.database import WriteSession

LONGEST = 128
"""characters of the columns that hold a text from outside"""

COMMAND_LINE = Principal(0, Role.ADMIN, "command line")
SERVICE = Principal(0, Role.ADMIN, "service")
NOBODY = Principal(0, Role.DEVICE, "unknown")
"""Actors without a key."""
WITHOUT_KEY = "none"
"""their role"""


def record(
    tx: WriteSession,
    principal: Principal,
    action: str,
    target: str | None,
    detail: dict[str, Any] | None,
    now: datetime,
) -> None:
    """Add an entry. Texts from outside are shown on one line, whatever is in them."""
    audit.add(
        tx,
        at=now,
        actor=plain.one_line(principal.name, LONGEST),
        key_pk=principal.key_pk or None,
        role=principal.role.word if principal.key_pk else WITHOUT_KEY,
        action=action,
        target=None if target is None else plain.one_line(target, LONGEST),
        detail=detail,
        request_id=REQUEST_ID.get(),
    )


def present(entry: audit.Entry) -> schemas.AuditEntry:
    """Give an entry as a document."""
    shown = entry._asdict()
    return schemas.AuditEntry(id=shown.pop("pk"), key_id=shown.pop("key_pk"), **shown)
