import type { Studio } from "../../model/studio.ts";

export function Program({ studio }: { studio: Studio }) {
  return <p>{studio.hello.value?.title}</p>;
}
