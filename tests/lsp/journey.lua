-- Opens a program, waits for its finding, repairs it, asks, renames, lays it out; writes what it saw as JSON.
local seen = {}
local function wait(what, condition)
  if not vim.wait(20000, condition, 20) then
    seen.failed = what
  end
end
local function request(method, params)
  for _, answer in pairs(vim.lsp.buf_request_sync(0, method, params, 20000) or {}) do
    return answer.result
  end
end
local function about(more)
  return vim.tbl_extend("error", { textDocument = vim.lsp.util.make_text_document_params() }, more)
end
local function at(line, character)
  return about({ position = { line = line, character = character } })
end

vim.cmd("edit " .. os.getenv("PROGRAM"))
wait("findings", function() return #vim.diagnostic.get(0) > 0 end)
local found = vim.diagnostic.get(0)[1] or {}
seen.filetype = vim.bo.filetype
seen.finding = { found.code, found.lnum, found.col }

local range = { start = { line = found.lnum, character = found.col }, ["end"] = { line = found.lnum, character = found.col } }
for _, action in ipairs(request("textDocument/codeAction", about({ range = range, context = { diagnostics = {} } }))) do
  if action.title:find("textmsg") then
    vim.lsp.util.apply_workspace_edit(action.edit, "utf-16")
    break
  end
end
wait("repair", function() return #vim.diagnostic.get(0) == 0 end)

seen.hover = request("textDocument/hover", at(2, 4)).contents.value
for _, item in ipairs(request("textDocument/completion", at(3, 4)).items) do
  if item.label == "textmsg" then
    seen.completion = item.label
  end
end

vim.api.nvim_win_set_cursor(0, { 2, 3 })
vim.lsp.buf.rename("high")
wait("rename", function() return vim.api.nvim_buf_get_lines(0, 3, 4, true)[1]:find("high") ~= nil end)

vim.api.nvim_buf_set_text(0, 1, 6, 1, 9, { "=" })
if vim.lsp.buf.format then
  vim.lsp.buf.format({ timeout_ms = 20000 })
else
  vim.lsp.buf.formatting_sync(nil, 20000)
end
seen.text = vim.api.nvim_buf_get_lines(0, 0, -1, true)

local file = io.open(os.getenv("SEEN"), "w")
file:write(vim.fn.json_encode(seen))
file:close()
vim.cmd("qall!")
