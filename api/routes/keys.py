"""Keys."""

from typing import Annotated

from fastapi import APIRouter, Depends, Path

from api import schemas
from api.dependencies import Admin, BeforeNumber, CurrentContext, Limit, Requires
from api.services import keyring, paging
from api.services.access import Role
from storage import keys

router = APIRouter(prefix="/keys", tags=["keys"], dependencies=[Depends(Requires(Role.ADMIN))])

Number = Annotated[int, Path(ge=1, le=2**63 - 1)]


@router.post("", status_code=201)
def create_key(draft: schemas.KeyDraft, principal: Admin, context: CurrentContext) -> schemas.CreatedKey:
    """Make a key. It is shown only in this answer."""
    return keyring.create(context, principal, keyring.Wanted(**draft.model_dump()))


@router.get("")
def list_keys(context: CurrentContext, after: BeforeNumber, limit: Limit = 100) -> schemas.Page[schemas.Key]:
    """List the keys in the order in which they were made: what they open, not the keys themselves."""
    with context.database.read() as tx:
        rows = keys.page(tx, limit + 1, after)
    return paging.page(rows, limit, lambda row: row.pk, keyring.present)


@router.delete("/{key_id}", status_code=204)
def revoke_key(key_id: Number, principal: Admin, context: CurrentContext) -> None:
    """Revoke a key; whoever signed in with it is signed out.

    409 `last-admin-key`: nobody could make another admin key afterwards.
    """
    keyring.revoke(context, principal, key_id)
