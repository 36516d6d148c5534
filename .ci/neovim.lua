-- Run by neovim.py inside of Neovim, with a wrong text in the buffer. Any error ends Neovim with code 1.
-- a guard against a hang, not a demand on speed
local PATIENCE = 300000 -- milliseconds

local function wait(what, condition)
  assert(vim.wait(PATIENCE, condition, 20), "in vain: " .. what)
end

local function try()
  wait("a client of eng", function()
    return #vim.lsp.get_clients({ bufnr = 0, name = "eng" }) == 1
  end)
  wait("a message", function()
    return #vim.diagnostic.get(0) > 0
  end)
  local messages = vim.diagnostic.get(0)
  assert(#messages == 1 and messages[1].source == "eng", vim.inspect(messages))
  local message = messages[1]
  assert(message.severity == vim.diagnostic.severity.ERROR)
  local line = vim.api.nvim_buf_get_lines(0, message.lnum, message.lnum + 1, true)[1]
  assert(line:sub(message.col + 1, message.end_col) == "degg", vim.inspect(message))

  -- the change that the message proposes
  vim.api.nvim_win_set_cursor(0, { message.lnum + 1, message.col })
  vim.lsp.buf.code_action({ apply = true })
  wait("the end of the message", function()
    return #vim.diagnostic.get(0) == 0
  end)

  vim.lsp.buf.format({ name = "eng", timeout_ms = PATIENCE })
  vim.cmd.write()
end

local done, reason = xpcall(try, debug.traceback)
if not done then
  io.stderr:write(reason .. "\n")
end
vim.cmd(done and "qall!" or "cquit 1")
