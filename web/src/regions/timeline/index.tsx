import type { Studio } from "../../model/studio.ts";

export function Timeline({ studio }: { studio: Studio }) {
  return <p>{studio.hello.value?.title}</p>;
}
