/** Who is signed in, and what they may do. */
import { queryOptions, useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { answer, http, Problem } from "./http";
import { keys } from "./keys";
import type { Role, SignedIn } from "./types";

const RANK: Record<Role, number> = { device: 0, installer: 1, manager: 2, admin: 3 };

/** The session, or null when nobody is signed in. */
export function useSession() {
  return useQuery(session);
}

export const session = queryOptions({
  queryKey: keys.session,
  queryFn: readSession,
  staleTime: Number.POSITIVE_INFINITY,
});

async function readSession(): Promise<SignedIn | null> {
  try {
    return await answer(http.GET("/api/v1/session"));
  } catch (error) {
    if (error instanceof Problem && error.status === 401) return null;
    throw error;
  }
}

export function useSignIn() {
  const client = useQueryClient();
  return useMutation({
    mutationFn: (key: string) => answer(http.POST("/api/v1/session", { body: { key } })),
    onSuccess: (session) => client.setQueryData(keys.session, session),
  });
}

export function useSignOut() {
  const client = useQueryClient();
  return useMutation({
    mutationFn: () => answer(http.DELETE("/api/v1/session")),
    onSuccess: () => {
      client.setQueryData(keys.session, null);
      client.removeQueries({ predicate: ({ queryKey }) => queryKey[0] !== keys.session[0] });
    },
  });
}

/** May somebody of this role do what needs the other one? */
export function atLeast(role: Role, needed: Role): boolean {
  return RANK[role] >= RANK[needed];
}

/** Is the person signed in at least of this role? */
export function useMay(needed: Role): boolean {
  const { data } = useSession();
  return data ? atLeast(data.role, needed) : false;
}
