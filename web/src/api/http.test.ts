import { describe, expect, it } from "vitest";
import { answer, Problem } from "./http";

const said = (status: number, error: unknown) =>
  answer(Promise.resolve({ error, response: new Response(null, { status }) })).catch(
    (problem: Problem) => problem,
  );

describe("answer", () => {
  it("gives the document", async () => {
    const request = Promise.resolve({
      data: { name: "Van 1" },
      response: new Response("{}", { status: 200 }),
    });
    expect(await answer(request)).toEqual({ name: "Van 1" });
  });

  it("speaks in the service's words", async () => {
    const problem = await said(409, { title: "Conflict", detail: "There is a device van-12 already." });
    expect(problem).toBeInstanceOf(Problem);
    expect(problem).toMatchObject({ status: 409, message: "There is a device van-12 already." });
  });

  it("tells which field of a form is wrong", async () => {
    const errors = [
      { pointer: "/body/name", message: "is too long" },
      { pointer: "/query/limit", message: "is too large" },
      { line: 3, message: "is not a number" },
    ];
    expect(await said(422, { detail: "Not valid.", errors })).toMatchObject({
      fields: { name: "is too long" },
    });
  });

  it.each([undefined, "", "<html>", { detail: 3 }])(
    "makes a sentence of an answer without words: %o",
    async (body) => {
      expect(await said(502, body)).toMatchObject({ message: "The service answered with status 502." });
    },
  );
});
